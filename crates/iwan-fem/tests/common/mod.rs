//! Small meshes and their files.
#![allow(dead_code, reason = "every test file uses some of these")]

use std::fmt::Write as _;

/// Corners of the unit hexahedron in the order of `Shape`.
pub(crate) const CORNERS: [[f64; 3]; 8] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 1.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0, 0.0, 1.0],
    [1.0, 1.0, 1.0],
    [0.0, 1.0, 1.0],
];

/// Edges whose middles are the nodes 8 to 19 of Abaqus' C3D20 (Abaqus Elements Guide, "Three-dimensional solid element library") and of
/// VTK's quadratic hexahedron ("VTK File Formats", cell type 25); `Shape::edges` must give the same.
pub(crate) const EDGES: [(usize, usize); 12] =
    [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)];

/// Edges in Gmsh's order of the same nodes (Gmsh reference manual, "Node ordering").
pub(crate) const GMSH_EDGES: [(usize, usize); 12] =
    [(0, 1), (0, 3), (0, 4), (1, 2), (1, 5), (2, 3), (2, 6), (3, 7), (4, 5), (4, 7), (5, 6), (6, 7)];

/// Corners, then the middles of the edges.
pub(crate) fn hex20(edges: &[(usize, usize); 12]) -> Vec<[f64; 3]> {
    let middle = |(a, b): &(usize, usize)| std::array::from_fn(|i| 0.5 * (CORNERS[*a][i] + CORNERS[*b][i]));
    CORNERS.iter().copied().chain(edges.iter().map(middle)).collect()
}

/// How the numbers of an MSH file are written.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Encoding {
    Ascii,
    Little,
    Big,
}

/// Writes MSH files number by number.
pub(crate) struct Msh {
    encoding: Encoding,
    pub(crate) bytes: Vec<u8>,
}

impl Msh {
    pub(crate) fn new(encoding: Encoding) -> Self {
        Self::version(encoding, "4.1")
    }

    fn version(encoding: Encoding, version: &str) -> Self {
        let mut msh = Self { encoding, bytes: Vec::new() };
        let kind = u8::from(encoding != Encoding::Ascii);
        msh.text(&format!("$MeshFormat\n{version} {kind} 8\n"));
        if encoding != Encoding::Ascii {
            msh.int(1);
            msh.text("\n");
        }
        msh.text("$EndMeshFormat\n");
        msh
    }

    pub(crate) fn text(&mut self, text: &str) -> &mut Self {
        self.bytes.extend_from_slice(text.as_bytes());
        self
    }

    fn put(&mut self, little: &[u8], text: impl std::fmt::Display) -> &mut Self {
        match self.encoding {
            Encoding::Ascii => self.text(&format!("{text} ")),
            Encoding::Little => {
                self.bytes.extend_from_slice(little);
                self
            }
            Encoding::Big => {
                self.bytes.extend(little.iter().rev());
                self
            }
        }
    }

    pub(crate) fn int(&mut self, value: i32) -> &mut Self {
        self.put(&value.to_le_bytes(), value)
    }

    pub(crate) fn ints(&mut self, values: &[i32]) -> &mut Self {
        for value in values {
            self.int(*value);
        }
        self
    }

    pub(crate) fn size(&mut self, value: u64) -> &mut Self {
        self.put(&value.to_le_bytes(), value)
    }

    pub(crate) fn sizes(&mut self, values: &[u64]) -> &mut Self {
        for value in values {
            self.size(*value);
        }
        self
    }

    pub(crate) fn numbers(&mut self, values: &[f64]) -> &mut Self {
        for v in values {
            self.put(&v.to_le_bytes(), v);
        }
        self
    }

    /// A file of one element on `points`, numbered from 11: as volume 1 in the groups 5 "block" and 6 without a name, and its bottom as
    /// surface 2 in the group 7 "bottom face".
    pub(crate) fn block(encoding: Encoding, points: &[[f64; 3]], kind: i32) -> Self {
        let mut msh = Self::new(encoding);
        msh.text(
            "$PhysicalNames\n3\n2 7 \"bottom face\"\n3 5 \"block\"\n1 9 \"nothing\"\n$EndPhysicalNames\n",
        );
        msh.text("$Entities\n").sizes(&[1, 0, 1, 1]);
        msh.int(1).numbers(&[0.0; 3]).size(0);
        msh.int(2).numbers(&[0.0; 6]).size(1).int(7).size(2).ints(&[3, -4]);
        msh.int(1).numbers(&[0.0; 6]).size(2).ints(&[5, 6]).size(0).text("\n$EndEntities\n");
        let count = points.len() as u64;
        msh.text("$Nodes\n").sizes(&[2, count, 11, 10 + count]);
        msh.ints(&[2, 2, 1]).sizes(&[4, 11, 12, 13, 14]);
        for point in &points[..4] {
            msh.numbers(point).numbers(&[0.5, 0.5]);
        }
        msh.ints(&[3, 1, 0]).size(count - 4);
        for label in 15..11 + count {
            msh.size(label);
        }
        for point in &points[4..] {
            msh.numbers(point);
        }
        msh.text("\n$EndNodes\n$Elements\n").sizes(&[2, 2, 1, 2]);
        msh.ints(&[2, 2, 3]).sizes(&[1, 1, 11, 12, 13, 14]);
        msh.ints(&[3, 1, kind]).sizes(&[1, 2]);
        for label in 11..11 + count {
            msh.size(label);
        }
        msh.text("\n$EndElements\n");
        msh
    }
}

impl Msh {
    /// The same element in version 2.2: as volume in the group 5 "block", its first three nodes as a triangle in group 7 "bottom face".
    pub(crate) fn block_two(encoding: Encoding, points: &[[f64; 3]], kind: i32) -> Self {
        let mut msh = Self::version(encoding, "2.2");
        msh.text(
            "$PhysicalNames\n3\n2 7 \"bottom face\"\n3 5 \"block\"\n1 9 \"nothing\"\n$EndPhysicalNames\n",
        );
        msh.text(&format!("$Nodes\n{}\n", points.len()));
        for (label, point) in (11..).zip(points) {
            msh.int(label).numbers(point);
        }
        msh.text("\n$EndNodes\n$Elements\n2\n");
        let labels: Vec<i32> = (11..).take(points.len()).collect();
        for (label, kind, tags, nodes) in [(1, 2, &[7, 2][..], &labels[..3]), (2, kind, &[5, 1, 0], &labels)]
        {
            let count = i32::try_from(tags.len()).expect("a few tags");
            if encoding == Encoding::Ascii {
                msh.ints(&[label, kind, count]);
            } else {
                msh.ints(&[kind, 1, count, label]);
            }
            msh.ints(tags).ints(nodes);
        }
        msh.text("\n$EndElements\n");
        msh
    }
}

/// Corners of the unit tetrahedron, then the middles of `edges`.
pub(crate) fn tet10(edges: &[(usize, usize); 6]) -> Vec<[f64; 3]> {
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let middle = |(a, b): &(usize, usize)| std::array::from_fn(|i| 0.5 * (corners[*a][i] + corners[*b][i]));
    corners.iter().copied().chain(edges.iter().map(middle)).collect()
}

/// Corners of the unit wedge, then the middles of `edges`.
pub(crate) fn wedge15(edges: &[(usize, usize); 9]) -> Vec<[f64; 3]> {
    let corners: Vec<[f64; 3]> =
        [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 1]].map(|p| p.map(f64::from)).to_vec();
    let middle = |(a, b): &(usize, usize)| std::array::from_fn(|i| 0.5 * (corners[*a][i] + corners[*b][i]));
    corners.iter().copied().chain(edges.iter().map(middle)).collect()
}

/// Edges whose middles are the nodes 4 to 9 of Abaqus' C3D10, and Gmsh's order of them (Gmsh reference manual, "Node ordering").
pub(crate) const TET_EDGES: [(usize, usize); 6] = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)];
pub(crate) const GMSH_TET_EDGES: [(usize, usize); 6] = [(0, 1), (1, 2), (2, 0), (3, 0), (3, 2), (3, 1)];
/// The same for the nodes 6 to 14 of C3D15 and of Gmsh's prism.
pub(crate) const WEDGE_EDGES: [(usize, usize); 9] =
    [(0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)];
pub(crate) const GMSH_WEDGE_EDGES: [(usize, usize); 9] =
    [(0, 1), (0, 2), (0, 3), (1, 2), (1, 4), (2, 5), (3, 4), (3, 5), (4, 5)];

/// Nodes of an Abaqus file, numbered from 11.
pub(crate) fn inp_nodes(points: &[[f64; 3]]) -> String {
    points.iter().zip(11..).fold("*NODE\n".into(), |mut text, ([x, y, z], label)| {
        writeln!(text, "{label}, {x}, {y}, {z}").expect("a string takes every text");
        text
    })
}

/// An Abaqus file with one element of each shape and sets of every kind.
pub(crate) fn inp() -> String {
    let shifted = hex20(&EDGES).into_iter().map(|[x, y, z]| [x, y, z + 2.0]);
    let points: Vec<_> = CORNERS.into_iter().chain(shifted).collect();
    let labels: Vec<_> = (19..39).map(|n: u32| n.to_string()).collect();
    format!(
        "*HEADING\na block\n{}** a comment\n*Element, type=C3D8, elset=Small\n1, 11, 12, 13, 14, 15, 16, 17, 18\n\
         *ELEMENT, TYPE=C3D20,\n ELSET=LARGE\n 2, {},\n{}\n*NSET, NSET=Bottom, GENERATE\n11, 14\n\
         *NSET, NSET=odd\n11, 13,\n 15\n*NSET, NSET=both\nBOTTOM, odd\n*NSET, NSET=all small, ELSET=small\n\
         *ELSET, ELSET=every\nsmall, LARGE\n*MATERIAL, NAME=STEEL\n*ELASTIC\n210000, 0.3\n*STEP\n*END STEP\n",
        inp_nodes(&points),
        labels[..15].join(", "),
        labels[15..].join(", ")
    )
}
