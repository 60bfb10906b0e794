//! Nodes, elements and named sets.

use std::collections::BTreeMap;

/// Topology of an element; the formulation on it is chosen by the analysis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Shape {
    /// Eight-node hexahedron: corners of the bottom face, counter-clockwise when seen from the top face, then those of the top
    /// face above them.
    Hex8,
    /// Twenty-node hexahedron: corners as [`Shape::Hex8`], then mid-edge nodes 0-1, 1-2, 2-3, 3-0, 4-5, 5-6, 6-7, 7-4,
    /// 0-4, 1-5, 2-6, 3-7.
    Hex20,
}

impl Shape {
    /// Number of nodes.
    #[must_use]
    pub fn nodes(self) -> usize {
        match self {
            Shape::Hex8 => 8,
            Shape::Hex20 => 20,
        }
    }

    /// Corners at the ends of each edge, in the order in which [`Shape::Hex20`] has its mid-edge nodes.
    ///
    /// ```
    /// use iwan_fem::mesh::Shape;
    /// assert_eq!(Shape::Hex8.edges()[3], (3, 0)); // node 11 of a twenty-node hexahedron lies between 3 and 0
    /// ```
    #[must_use]
    pub const fn edges(self) -> &'static [(usize, usize)] {
        match self {
            Self::Hex8 | Self::Hex20 => &HEXAHEDRON_EDGES,
        }
    }
}

/// Edges of the bottom face, of the top face, and between the two: the order of Abaqus C3D20 and of VTK's quadratic hexahedron.
const HEXAHEDRON_EDGES: [(usize, usize); 12] =
    [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)];

/// One element.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Element {
    /// Number of the element in the file it came from: errors name it.
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
    /// Number of each node in the file it came from: errors name it.
    pub node_labels: Vec<u64>,
    /// Elements.
    pub elements: Vec<Element>,
    /// Named sets of nodes, as indices into [`Mesh::positions`], ascending.
    pub node_sets: BTreeMap<String, Vec<usize>>,
    /// Named sets of elements, as indices into [`Mesh::elements`], ascending.
    pub element_sets: BTreeMap<String, Vec<usize>>,
}
