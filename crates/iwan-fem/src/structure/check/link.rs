//! Joints and ties with their nodes.

use super::super::description::Structure;
use super::super::interface::{Interface, Joint};

/// A tie or joint with its nodes.
#[derive(Debug, Clone)]
pub(super) struct Link<'a> {
    /// Name, for messages.
    pub(super) name: String,
    pub(super) interface: Interface,
    /// Indices of the nodes that follow, such as those of a washer's face.
    pub(super) face: &'a [usize],
    /// Indices of the nodes that are followed.
    pub(super) patch: &'a [usize],
}

/// Name of a joint for messages; a joint without slips is called a tie.
pub(super) fn name(joint: &Joint) -> String {
    let word = if joint.slips.is_empty() { "tie" } else { "joint" };
    format!("{word} `{}`", joint.name)
}

/// The joints and ties whose sets exist.
pub(super) fn links(structure: &Structure) -> Vec<Link<'_>> {
    let set = |name: &str| structure.mesh.node_sets.get(name).map(Vec::as_slice);
    let link = |joint: &Joint| {
        Some(Link {
            name: name(joint),
            interface: joint.interface,
            face: set(&joint.face)?,
            patch: set(&joint.patch)?,
        })
    };
    structure.joints.iter().filter_map(link).collect()
}
