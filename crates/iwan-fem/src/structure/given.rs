//! Stiffness and mass that another program computed, in place of elements.

use crate::algebra::Symmetric;

/// What a row of given matrices is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Row {
    /// Displacement of a node (index into the mesh) along x, y or z (0, 1, 2).
    Displacement {
        /// Index of the node.
        node: usize,
        /// Axis.
        axis: usize,
    },
    /// Rotation of a node about x, y or z (0, 1, 2).
    Rotation {
        /// Index of the node.
        node: usize,
        /// Axis.
        axis: usize,
    },
    /// A generalised coordinate, such as that of a fixed-interface mode.
    Generalised,
}

/// Stiffness and mass from another program: they stand in place of all elements. Nodes of the mesh say where rows are.
#[derive(Debug, Clone, PartialEq)]
pub struct Given {
    /// What each row is; no two rows are the same displacement or rotation.
    pub rows: Vec<Row>,
    /// Stiffness of everything but the joints of the structure.
    pub stiffness: Symmetric,
    /// Mass.
    pub mass: Symmetric,
    /// Viscous damping; none: none.
    pub damping: Option<Symmetric>,
    /// Whether the nodes have positions. Without them rotations of a set of nodes are unknown, and so are rigid rotations.
    pub placed: bool,
}
