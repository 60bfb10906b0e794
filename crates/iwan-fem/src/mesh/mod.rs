//! Nodes, elements and named sets: what every reader delivers and the assembly starts from.

mod abaqus;
pub mod beam;
pub mod block;
mod error;
mod gmsh;
mod labels;
mod read;
mod sets;
mod source;
mod surface;
pub mod vtu;

pub use error::{MeshError, MeshWarning};
pub use read::{MeshFile, read, read_bytes};

use std::collections::BTreeMap;

/// Topology of an element; the formulation on it is chosen by the analysis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Shape {
    /// Eight-node hexahedron: bottom face counter-clockwise seen from outside the top, then the top face.
    Hex8,
    /// Twenty-node hexahedron: corners as [`Shape::Hex8`], then mid-edge nodes 0-1, 1-2, 2-3, 3-0, 4-5, 5-6, 6-7, 7-4,
    /// 0-4, 1-5, 2-6, 3-7 (the order of Abaqus C3D20 and VTK).
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
}

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
