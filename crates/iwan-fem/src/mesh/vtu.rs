//! Output of meshes with fields for ParaView: VTU (XML unstructured grid, raw appended data) and PVD (a series in time).
//!
//! Layout after "VTK XML Formats" of the VTK documentation. The writer is our own because a grid takes only a page of XML and runs of
//! numbers, while the crate for it brings readers of other formats and dependencies from 2017.

use std::fmt::Write;

use super::topology::{Element, Mesh, Shape};

/// Values at the nodes of a mesh.
#[derive(Debug, Clone, Copy)]
pub struct Field<'a> {
    /// Name, as ParaView shows it.
    pub name: &'a str,
    /// Three values (x, y, z) or one value per node, node by node.
    pub values: &'a [f64],
}

/// The appended data, in the order in which they are stored.
#[derive(Default)]
struct Appended {
    bytes: Vec<u8>,
}

impl Appended {
    /// Adds an array (its length in bytes, then its bytes), and returns the XML element that refers to it.
    fn array(&mut self, attributes: &str, data: impl Iterator<Item = u8>) -> String {
        let (offset, start) = (self.bytes.len(), self.bytes.len() + 8);
        self.bytes.extend_from_slice(&[0; 8]);
        self.bytes.extend(data);
        let length = (self.bytes.len() - start) as u64;
        self.bytes[offset..start].copy_from_slice(&length.to_le_bytes());
        format!("<DataArray {attributes} format=\"appended\" offset=\"{offset}\"/>\n")
    }

    fn floats(&mut self, name: &str, components: usize, values: &[f64]) -> String {
        let name = escaped(name);
        let attributes = format!("type=\"Float64\" Name=\"{name}\" NumberOfComponents=\"{components}\"");
        self.array(&attributes, values.iter().flat_map(|v| v.to_le_bytes()))
    }

    fn integers(&mut self, name: &str, values: impl Iterator<Item = i64>) -> String {
        self.array(&format!("type=\"Int64\" Name=\"{name}\""), values.flat_map(i64::to_le_bytes))
    }
}

/// A mesh with `fields`, as the bytes of a `.vtu` file; the numbers of nodes and elements in the mesh file are added as further fields.
///
/// # Panics
/// When a field has neither one nor three values for each node.
#[must_use]
pub fn grid(mesh: &Mesh, fields: &[Field]) -> Vec<u8> {
    let (nodes, elements) = (mesh.positions.len(), mesh.elements.len());
    let mut data = Appended::default();
    let mut body = String::from("<PointData>\n");
    body += &data.integers("node", mesh.node_labels.iter().map(|label| label.cast_signed()));
    for field in fields {
        let components = if field.values.len() == nodes { 1 } else { 3 };
        assert_eq!(
            field.values.len(),
            components * nodes,
            "field {} has a value or vector for each node",
            field.name
        );
        body += &data.floats(field.name, components, field.values);
    }
    body += "</PointData>\n<CellData>\n";
    body += &data.integers("element", mesh.elements.iter().map(|element| element.label.cast_signed()));
    body += "</CellData>\n<Points>\n";
    body += &data.floats("Points", 3, mesh.positions.as_flattened());
    body += "</Points>\n<Cells>\n";
    body += &data.integers(
        "connectivity",
        mesh.elements.iter().flat_map(in_vtk_order).map(|n| i64::try_from(n).unwrap_or(i64::MAX)),
    );
    let ends = mesh.elements.iter().scan(0, |end, element| {
        *end += i64::try_from(element.nodes.len()).unwrap_or_default();
        Some(*end)
    });
    body += &data.integers("offsets", ends.collect::<Vec<_>>().into_iter());
    body += &data
        .array("type=\"UInt8\" Name=\"types\"", mesh.elements.iter().map(|element| cell_type(element.shape)));
    body += "</Cells>\n";
    let mut file = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" \
         header_type=\"UInt64\">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\"{nodes}\" NumberOfCells=\"{elements}\">\n\
         {body}</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_"
    )
    .into_bytes();
    file.extend_from_slice(&data.bytes);
    file.extend_from_slice(b"\n</AppendedData>\n</VTKFile>\n");
    file
}

/// A series of grids, as the text of a `.pvd` file: time in s, and the path of each `.vtu` file relative to it.
#[must_use]
pub fn series<'a>(frames: impl Iterator<Item = (f64, &'a str)>) -> String {
    let mut text = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n<Collection>\n",
    );
    for (time, path) in frames {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "<DataSet timestep=\"{time}\" part=\"0\" file=\"{}\"/>", escaped(path));
    }
    text + "</Collection>\n</VTKFile>\n"
}

/// VTK's number for the type of cell.
fn cell_type(shape: Shape) -> u8 {
    match shape {
        Shape::Hex8 => 12,
        Shape::Hex20 => 25,
        Shape::Tet4 => 10,
        Shape::Tet10 => 24,
        Shape::Wedge6 => 13,
        Shape::Wedge15 => 26,
    }
}

/// The element's nodes in VTK's order: that of [`Shape`], except that VTK sees the bottom triangle of the six-node wedge from below
/// (vtkWedge: "a triangle whose normal points outward").
fn in_vtk_order(element: &Element) -> impl Iterator<Item = usize> + '_ {
    const WEDGE: [usize; 6] = [0, 2, 1, 3, 5, 4];
    let turned = element.shape == Shape::Wedge6;
    (0..element.nodes.len()).map(move |at| element.nodes[if turned { WEDGE[at] } else { at }])
}

/// A text escaped for use in an XML attribute.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
