//! Nodes, elements and named sets.

use std::collections::BTreeMap;

/// Topology of an element; the analysis chooses the formulation.
///
/// Corners and mid-edge nodes are in the order of Abaqus and CalculiX.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Shape {
    /// Eight-node hexahedron: corners of the bottom face, counter-clockwise when seen from the top face, then those of the top
    /// face above them.
    Hex8,
    /// Twenty-node hexahedron: corners as [`Shape::Hex8`], then mid-edge nodes 0-1, 1-2, 2-3, 3-0, 4-5, 5-6, 6-7, 7-4,
    /// 0-4, 1-5, 2-6, 3-7.
    Hex20,
    /// Four-node tetrahedron: corners of the bottom face, counter-clockwise when seen from the fourth.
    Tet4,
    /// Ten-node tetrahedron: corners as [`Shape::Tet4`], then mid-edge nodes 0-1, 1-2, 2-0, 0-3, 1-3, 2-3.
    Tet10,
    /// Six-node wedge: corners of the bottom triangle, counter-clockwise when seen from the top one, then those above them.
    Wedge6,
    /// Fifteen-node wedge: corners as [`Shape::Wedge6`], then mid-edge nodes 0-1, 1-2, 2-0, 3-4, 4-5, 5-3, 0-3, 1-4, 2-5.
    Wedge15,
}

impl Shape {
    /// Number of nodes.
    #[must_use]
    pub const fn nodes(self) -> usize {
        match self {
            Self::Hex8 => 8,
            Self::Hex20 => 20,
            Self::Tet4 => 4,
            Self::Tet10 => 10,
            Self::Wedge6 => 6,
            Self::Wedge15 => 15,
        }
    }

    /// Number of corners, which come first among the nodes.
    #[must_use]
    pub const fn corners(self) -> usize {
        match self {
            Self::Hex8 | Self::Hex20 => 8,
            Self::Tet4 | Self::Tet10 => 4,
            Self::Wedge6 | Self::Wedge15 => 6,
        }
    }

    /// Whether the shape has nodes in the middle of its edges.
    #[must_use]
    pub const fn has_middles(self) -> bool {
        self.nodes() > self.corners()
    }

    /// Corners at the two ends of each edge, in the order of the mid-edge nodes.
    ///
    /// ```
    /// use iwan_fem::mesh::Shape;
    /// assert_eq!(Shape::Hex8.edges()[3], (3, 0)); // node 11 of a twenty-node hexahedron lies between 3 and 0
    /// assert_eq!(Shape::Tet10.edges()[5], (2, 3)); // node 9 of a ten-node tetrahedron lies between 2 and 3
    /// ```
    #[must_use]
    pub const fn edges(self) -> &'static [(usize, usize)] {
        match self {
            Self::Hex8 | Self::Hex20 => &HEXAHEDRON_EDGES,
            Self::Tet4 | Self::Tet10 => &TETRAHEDRON_EDGES,
            Self::Wedge6 | Self::Wedge15 => &WEDGE_EDGES,
        }
    }

    /// Corners of each face, counter-clockwise when seen from outside, in the order of the faces S1, S2, ... of Abaqus and CalculiX.
    ///
    /// ```
    /// use iwan_fem::mesh::Shape;
    /// assert_eq!(Shape::Wedge15.faces().map(<[usize]>::len).collect::<Vec<_>>(), [3, 3, 4, 4, 4]);
    /// ```
    pub fn faces(self) -> impl Iterator<Item = &'static [usize]> {
        match self {
            Self::Hex8 | Self::Hex20 => HEXAHEDRON_FACES,
            Self::Tet4 | Self::Tet10 => TETRAHEDRON_FACES,
            Self::Wedge6 | Self::Wedge15 => WEDGE_FACES,
        }
        .iter()
        .copied()
    }
}

/// Edges of the bottom face, of the top face, and between the two: the order of Abaqus C3D20 and of VTK's quadratic hexahedron.
const HEXAHEDRON_EDGES: [(usize, usize); 12] =
    [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)];
/// Edges of the bottom face, then those to the top: the order of Abaqus C3D10 and of VTK's quadratic tetrahedron.
const TETRAHEDRON_EDGES: [(usize, usize); 6] = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)];
/// Edges of the bottom face, of the top face, and between the two: the order of Abaqus C3D15 and of VTK's quadratic wedge.
const WEDGE_EDGES: [(usize, usize); 9] =
    [(0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)];

const HEXAHEDRON_FACES: &[&[usize]] =
    &[&[0, 3, 2, 1], &[4, 5, 6, 7], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]];
const TETRAHEDRON_FACES: &[&[usize]] = &[&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[2, 0, 3]];
const WEDGE_FACES: &[&[usize]] = &[&[0, 2, 1], &[3, 4, 5], &[0, 1, 4, 3], &[1, 2, 5, 4], &[2, 0, 3, 5]];

/// One element.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Element {
    /// Number of the element in the mesh file, used in errors.
    pub label: u64,
    /// Topology.
    pub shape: Shape,
    /// Indices into [`Mesh::positions`], in the order of [`Shape`].
    pub nodes: Vec<usize>,
}

/// A mesh: nodes, elements, named sets.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mesh {
    /// Position of each node, in the user's unit of length.
    pub positions: Vec<[f64; 3]>,
    /// Number of each node in the mesh file, used in errors.
    pub node_labels: Vec<u64>,
    /// Elements.
    pub elements: Vec<Element>,
    /// Named sets of nodes, as indices into [`Mesh::positions`], ascending.
    pub node_sets: BTreeMap<String, Vec<usize>>,
    /// Named sets of elements, as indices into [`Mesh::elements`], ascending.
    pub element_sets: BTreeMap<String, Vec<usize>>,
    /// Instances of parts by name, with the number that was added to the numbers of their nodes and elements.
    pub instances: BTreeMap<String, u64>,
}
