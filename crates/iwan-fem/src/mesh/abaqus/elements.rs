//! Reader of `*ELEMENT`.

use super::super::error::MeshError;
use super::super::file::{FileBytes, quote};
use super::super::labels::Labels;
use super::super::topology::{Element, Shape};
use super::definition::{Definition, SetKind};
use super::fields::whole;
use super::keyword::Keyword;
use super::lines::Lines;
use super::reader::{ReadAs, Reader, Skin, number_of, within};

/// An element type of Abaqus; `read_as` is what it is read as if its name implies a formulation of its own.
struct ElementType {
    name: &'static str,
    shape: Shape,
    read_as: Option<&'static str>,
}

const fn entry(name: &'static str, shape: Shape, read_as: Option<&'static str>) -> ElementType {
    ElementType { name, shape, read_as }
}

static TYPES: &[ElementType] = &[
    entry("C3D8", Shape::Hex8, Some("a hexahedron of 8 nodes")),
    entry("C3D8I", Shape::Hex8, None),
    entry("C3D8R", Shape::Hex8, Some("a hexahedron of 8 nodes")),
    entry("C3D20", Shape::Hex20, None),
    entry("C3D20R", Shape::Hex20, Some("a hexahedron of 20 nodes")),
    entry("C3D4", Shape::Tet4, None),
    entry("C3D10", Shape::Tet10, None),
    entry("C3D10M", Shape::Tet10, Some("a tetrahedron of 10 nodes")),
    entry("C3D10HS", Shape::Tet10, Some("a tetrahedron of 10 nodes")),
    entry("C3D10T", Shape::Tet10, Some("a tetrahedron of 10 nodes")),
    entry("C3D6", Shape::Wedge6, None),
    entry("C3D15", Shape::Wedge15, None),
];

/// Line and surface elements with their numbers of nodes. Gmsh writes them beside the volume elements; without a section they are no part
/// of the model.
static SKINS: &[(&str, usize)] = &[
    ("T3D2", 2),
    ("T3D3", 3),
    ("B31", 2),
    ("B32", 3),
    ("CPS3", 3),
    ("CPS4", 4),
    ("CPS4R", 4),
    ("CPS6", 6),
    ("CPS8", 8),
    ("CPS8R", 8),
    ("CPE3", 3),
    ("CPE4", 4),
    ("CPE6", 6),
    ("CPE8", 8),
    ("S3", 3),
    ("S3R", 3),
    ("STRI3", 3),
    ("S4", 4),
    ("S4R", 4),
    ("S6", 6),
    ("STRI65", 6),
    ("S8", 8),
    ("S8R", 8),
    ("SFM3D3", 3),
    ("SFM3D4", 4),
    ("SFM3D4R", 4),
    ("SFM3D6", 6),
    ("SFM3D8", 8),
    ("R3D3", 3),
    ("M3D3", 3),
    ("M3D4", 4),
    ("M3D6", 6),
    ("M3D8", 8),
];

impl Reader {
    /// Reads the numbers and nodes of elements; the nodes remain numbers of the file until [`resolve`].
    pub(super) fn elements(&mut self, lines: &mut Lines, keyword: &Keyword) -> Result<(), MeshError> {
        keyword.only(lines.source, &["TYPE", "ELSET"])?;
        let given = keyword.required(lines.source, "TYPE")?;
        if given.eq_ignore_ascii_case("MASS") || given.eq_ignore_ascii_case("ROTARYI") {
            return self.mass_elements(lines, keyword);
        }
        if let Some(&(name, count)) = SKINS.iter().find(|skin| skin.0.eq_ignore_ascii_case(given)) {
            return self.skin(lines, keyword, name, count);
        }
        let Some(kind) = TYPES.iter().find(|t| t.name.eq_ignore_ascii_case(given)) else {
            let found = format!("element type {}", quote(given.as_bytes(), 40));
            let names: Vec<_> = TYPES.iter().map(|t| t.name).collect();
            let remedy = format!(
                "mesh with hexahedra, tetrahedra or wedges (shells and beams come in by [matrices]); read are {}",
                names.join(", ")
            );
            return Err(keyword.refused(lines.source, &found, &remedy));
        };
        if let Some(read_as) = kind.read_as {
            self.formulations.entry(kind.name).or_insert(ReadAs { line: keyword.line, read_as });
        }
        let own = self.within();
        let body = self.body();
        let first = body.elements.len();
        while let Some((mut element, offset)) = element(lines, kind)? {
            element.label = within(own, element.label);
            element.nodes.iter_mut().for_each(|node| *node = within(own, *node as u64) as usize);
            body.element_lines.push(offset);
            body.elements.push(element);
        }
        if let Some(name) = keyword.value("ELSET") {
            let added = body.elements[first..].iter().map(|e| number_of(e.label)).collect();
            let name = self.named(name);
            let definition = Definition::of(SetKind::Elements, &name, keyword.line, added, own);
            self.body().definitions.push(definition);
        }
        Ok(())
    }
}

impl Reader {
    /// Reads surface or line elements, whose nodes form a set. Whether a section gives them stiffness is checked at the end of the file.
    fn skin(
        &mut self,
        lines: &mut Lines,
        keyword: &Keyword,
        kind: &'static str,
        count: usize,
    ) -> Result<(), MeshError> {
        let (mut found, mut pending) = (Vec::new(), 0);
        while let Some(line) = lines.next_data() {
            let mut fields = line.fields();
            if pending == 0 {
                let label = fields.next().unwrap_or_default();
                let label = whole(lines.source, &line, label, "the number of an element")?;
                found.push((label, Vec::with_capacity(count)));
                pending = count;
            }
            for field in fields {
                let node = whole(lines.source, &line, field, format_args!("a node of {kind}"))?;
                if let Some((_, nodes)) = found.last_mut() {
                    nodes.push(node);
                }
                pending = pending.checked_sub(1).ok_or_else(|| {
                    let found = format!("an element {kind} with more than {count} nodes");
                    lines.source.malformed(line.place(lines.source), found, format!("{count} nodes"))
                })?;
            }
            if pending > 0 && !line.continues() {
                let found = format!("an element {kind} with {} nodes", count - pending);
                return Err(lines.source.malformed(
                    line.place(lines.source),
                    found,
                    format!("{count} nodes"),
                ));
            }
        }
        let set = keyword.value("ELSET").map(|name| self.named(name));
        self.skins.push(Skin { kind, line: keyword.line, elements: found.len(), set: set.clone() });
        if let Some(name) = set {
            let nodes = found.iter().flat_map(|(_, nodes)| nodes).copied().collect();
            self.nodes_of_skin(&name, keyword.line, nodes);
        }
        self.body().skin.extend(found);
        Ok(())
    }

    /// Defines a node set from the nodes of surface or line elements, each node once.
    pub(super) fn nodes_of_skin(&mut self, name: &str, line: usize, mut nodes: Vec<u64>) {
        nodes.sort_unstable();
        nodes.dedup();
        let definition = Definition::of(SetKind::Nodes, name, line, nodes, self.within());
        self.body().definitions.push(definition);
    }

    /// Reads mass elements, which have one node each; `*MASS` gives their mass later.
    fn mass_elements(&mut self, lines: &mut Lines, keyword: &Keyword) -> Result<(), MeshError> {
        let set = self.named(keyword.required(lines.source, "ELSET")?).to_uppercase();
        let own = self.within();
        let nodes = self.body().mass_elements.entry(set).or_default();
        while let Some(line) = lines.next_data() {
            let mut fields = line.fields();
            let label =
                whole(lines.source, &line, fields.next().unwrap_or_default(), "the number of an element")?;
            let what = format_args!("the node of element {label}");
            nodes.push(within(own, whole(lines.source, &line, fields.next().unwrap_or_default(), what)?));
        }
        Ok(())
    }

    /// Name preceded by that of the present instance.
    pub(super) fn named(&self, name: &str) -> String {
        match self.within().checked_sub(1) {
            Some(at) => format!("{}.{name}", self.instances[at]),
            None => name.into(),
        }
    }
}

/// Reads the next element and the byte offset of its first line; a line that ends in a comma is continued on the next one.
fn element(lines: &mut Lines, kind: &ElementType) -> Result<Option<(Element, usize)>, MeshError> {
    let Some(mut line) = lines.next_data() else { return Ok(None) };
    let offset = line.offset;
    let mut fields = line.fields();
    let label = whole(lines.source, &line, fields.next().unwrap_or_default(), "the number of an element")?;
    let wanted = kind.shape.nodes();
    let mut nodes = Vec::with_capacity(wanted);
    loop {
        for field in fields {
            let node = whole(lines.source, &line, field, format_args!("a node of element {label}"))?;
            nodes.push(node as usize);
            if nodes.len() > wanted {
                let found = format!("element {label} with more than {wanted} nodes");
                let expected = format!("the {wanted} nodes of {}", kind.name);
                return Err(lines.source.malformed(line.place(lines.source), found, expected));
            }
        }
        if nodes.len() == wanted {
            return Ok(Some((Element { label, shape: kind.shape, nodes }, offset)));
        }
        let next = if line.continues() { lines.next_data() } else { None };
        let Some(next) = next else {
            let found = format!("element {label} with {} nodes", nodes.len());
            let expected = format!(
                "the {wanted} nodes of {} (a line ends in a comma when the next continues it)",
                kind.name
            );
            return Err(lines.source.malformed(line.place(lines.source), found, expected));
        };
        line = next;
        fields = line.fields();
    }
}

/// Replaces the numbers of the nodes of elements by indices.
pub(super) fn resolve(
    source: FileBytes,
    elements: &mut [Element],
    lines: &[usize],
    nodes: &Labels,
) -> Result<(), MeshError> {
    for (element, offset) in elements.iter_mut().zip(lines) {
        for node in &mut element.nodes {
            *node = nodes.index(*node as u64).ok_or_else(|| {
                let line = source.at_line(source.line(*offset));
                let place = format!("{line}, element {}", number_of(element.label));
                let found = format!("node {}", number_of(*node as u64));
                source.malformed(place, found, "the number of a node of this file, or of this instance")
            })?;
        }
    }
    Ok(())
}
