//! Everything that was read of an Abaqus input file so far.

use std::collections::BTreeMap;

use super::super::axes::Axes;
use super::super::topology::Element;
use super::definition::Definition;
use super::parts::Parts;

/// Nodes, elements and sets; nodes of elements and members of sets are numbers of the file until all is read.
#[derive(Default)]
pub(super) struct Reader {
    pub(super) positions: Vec<[f64; 3]>,
    pub(super) node_labels: Vec<u64>,
    /// Byte of the line of each node.
    pub(super) node_lines: Vec<usize>,
    pub(super) elements: Vec<Element>,
    /// Byte of the line of each element.
    pub(super) element_lines: Vec<usize>,
    pub(super) definitions: Vec<Definition>,
    pub(super) parts: Parts,
    /// Axes in which nodes are given from now on.
    pub(super) axes: Axes,
    /// Names of keywords that the user wants to be passed over.
    pub(super) ignored: Vec<String>,
    /// Keywords that mean nothing to a mesh, by their names.
    pub(super) passed_over: BTreeMap<String, PassedOver>,
    /// Element types that name a formulation, by their names.
    pub(super) formulations: BTreeMap<&'static str, ReadAs>,
}

/// A keyword that means nothing to a mesh.
pub(super) struct PassedOver {
    /// Line of the first one.
    pub(super) line: usize,
    /// How often it occurs.
    pub(super) times: usize,
}

/// An element type that is read in another sense than the file's.
pub(super) struct ReadAs {
    /// Line of the first block of elements of this type.
    pub(super) line: usize,
    pub(super) read_as: &'static str,
}
