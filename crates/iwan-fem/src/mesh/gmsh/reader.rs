//! All contents of a MSH file that have been read so far.

use super::super::labels::Labels;
use super::super::sets::Sets;
use super::super::topology::Mesh;
use super::groups::Groups;

/// Mesh and sets under construction.
pub(super) struct Reader {
    pub(super) mesh: Mesh,
    pub(super) groups: Groups,
    /// Numbers of the nodes; none before `$Nodes`.
    pub(super) nodes: Option<Labels>,
    pub(super) node_sets: Sets,
    pub(super) element_sets: Sets,
    pub(super) elements_seen: bool,
    pub(super) passed_over: Vec<PassedOver>,
}

/// A section that is not needed for a mesh and is passed over.
pub(super) struct PassedOver {
    pub(super) name: String,
    /// Byte at which the first section of this name begins.
    pub(super) offset: usize,
    /// Number of such sections.
    pub(super) times: usize,
}

impl Reader {
    /// The reader before a file of `length` bytes is read.
    pub(super) fn new(length: usize) -> Self {
        Self {
            mesh: Mesh::default(),
            groups: Groups::default(),
            nodes: None,
            node_sets: Sets::new(length),
            element_sets: Sets::new(length),
            elements_seen: false,
            passed_over: Vec::new(),
        }
    }
}
