//! Stiffness and mass from another program, in place of elements.

use super::interface::Law;
use crate::algebra::Symmetric;

/// Meaning of a row of given matrices.
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

/// A displacement of a node that the rows of given matrices determine: one row of a recovery matrix.
#[derive(Debug, Clone, PartialEq)]
pub struct Recovered {
    /// Index of the node; the matrices have no row for this displacement.
    pub node: usize,
    /// Axis.
    pub axis: usize,
    /// Rows of the matrices (from 0) and coefficients: u = Σ c x.
    pub terms: Vec<(usize, f64)>,
}

/// A joint between rows of given matrices: its law acts on the slip Σ c x, one row of a matrix of relative displacements.
#[derive(Clone)]
pub struct RelativeSlip {
    /// Name of the slip: the names of joint and row.
    pub name: String,
    /// Rows of the matrices (from 0) and coefficients.
    pub terms: Vec<(usize, f64)>,
    /// The law; a slip without a law slides freely.
    pub law: Option<Law>,
    /// Whether the joint acts against the ground; only then may its slip contain rigid motion of the structure.
    pub to_ground: bool,
}

impl std::fmt::Debug for RelativeSlip {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("RelativeSlip")
            .field("name", &self.name)
            .field("terms", &self.terms)
            .finish_non_exhaustive()
    }
}

/// Stiffness and mass from another program, in place of all elements. The nodes of the mesh give the positions of the rows.
#[derive(Debug, Clone)]
pub struct Given {
    /// Meaning of each row; no two rows are the same displacement or rotation.
    pub rows: Vec<Row>,
    /// Stiffness of everything but the joints of the structure.
    pub stiffness: Symmetric,
    /// Mass.
    pub mass: Symmetric,
    /// Viscous damping, if there is some.
    pub damping: Option<Symmetric>,
    /// Whether the nodes have positions. Without positions rotations of a set of nodes and rigid rotations are unknown.
    pub placed: bool,
    /// Displacements of further nodes in terms of the rows, for outputs, loads and pictures.
    pub recovered: Vec<Recovered>,
    /// Joints that act on rows of a matrix of relative displacements.
    pub relative: Vec<RelativeSlip>,
}

impl Given {
    /// Index of each row among the degrees of freedom: first the three displacements of each of `nodes` nodes, then all other rows in their
    /// order.
    pub(crate) fn freedoms(&self, nodes: usize) -> Vec<usize> {
        let mut further = 3 * nodes;
        let number = |row: &Row| match *row {
            Row::Displacement { node, axis } => 3 * node + axis,
            Row::Rotation { .. } | Row::Generalised => {
                further += 1;
                further - 1
            }
        };
        self.rows.iter().map(number).collect()
    }
}
