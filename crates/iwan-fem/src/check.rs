//! Whether a mesh can be computed with: every defect is named with the numbers of its elements and nodes, and a remedy.

mod connections;
mod finding;
mod nodes;
mod parts;
mod quality;

pub use finding::{Defect, Remark};

use crate::mesh::Mesh;

/// How two groups of nodes are connected.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Connection {
    /// The face follows the patch, whose nodes move as one rigid body.
    Rigid,
    /// The face follows the rigid motion that fits the patch best.
    Averaging,
    /// Each node of the face follows the node of the patch at its place.
    NodeToNode,
}

/// A tie or joint, as far as the mesh is concerned.
#[derive(Debug, Clone, Copy)]
pub struct Link<'a> {
    /// Name for messages, such as `joint "left bolt"`.
    pub name: &'a str,
    /// How it connects.
    pub connection: Connection,
    /// Indices of the nodes that follow, such as those of a washer's face.
    pub face: &'a [usize],
    /// Indices of the nodes that lead.
    pub patch: &'a [usize],
}

/// What a check found.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Findings {
    /// What makes a computation impossible or wrong.
    pub defects: Vec<Defect>,
    /// What is allowed, but seldom meant.
    pub remarks: Vec<Remark>,
}

impl Findings {
    /// All defects as one text, one per line; none for a sound mesh.
    #[must_use]
    pub fn message(&self) -> Option<String> {
        let lines: Vec<String> = self.defects.iter().map(ToString::to_string).collect();
        (!lines.is_empty()).then(|| lines.join("\n"))
    }
}

/// Checks a mesh with its ties and joints.
///
/// Defects: elements that are inverted, collapsed or use a node twice (the Jacobian determinant at the integration
/// points and at the corners must be positive), elements with the same nodes, nodes without an element, nodes at the
/// same place within one part, parts that nothing connects with the rest, and ties and joints that cannot work.
/// Two nodes are at the same place when they are closer than [`COINCIDENT`] of the shortest edge at either. Nodes of
/// two *different* parts at the same place are a remark unless a tie or joint connects them: contact faces are meant
/// to be so.
///
/// Time grows with the size of the mesh, but for the nearest pair between the two sides of a link, which takes the
/// product of their sizes.
#[must_use]
pub fn check(mesh: &Mesh, links: &[Link]) -> Findings {
    let mut findings = Findings::default();
    quality::check(mesh, &mut findings);
    let parts = parts::Parts::new(mesh);
    let sizes = nodes::sizes(mesh);
    let pairs = nodes::coincident(mesh, &sizes);
    nodes::orphans(mesh, &parts, &mut findings);
    nodes::report(mesh, &parts, &pairs, links, &mut findings);
    parts::unconnected(mesh, &parts, &pairs, links, &mut findings);
    connections::check(mesh, &sizes, links, &mut findings);
    findings
}

/// Two nodes closer than this share of the shortest edge at either are at the same place: files with six digits
/// round much less, and no sound element is so thin.
pub const COINCIDENT: f64 = 1e-3;
