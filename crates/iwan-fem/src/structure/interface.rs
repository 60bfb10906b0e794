//! Bolted interfaces: which nodes follow which, where they slip, and by which law.

use std::fmt;
use std::sync::Arc;

use iwan_core::Backbone;

/// A joint law that any number of joints and threads share.
pub type Law = Arc<dyn Backbone + Send + Sync>;

/// How a patch of nodes defines the motion that the face of a joint follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Patch {
    /// All nodes of the patch move as one rigid body (RBE2).
    Rigid,
    /// The face follows the rigid motion that fits the displacements of the patch's nodes best, equally weighted; the patch stays flexible
    /// (RBE3).
    #[default]
    Averaging,
}

/// A direction in which a joint slips, with the law for that direction.
#[derive(Clone)]
pub struct Slip {
    /// Direction of the slip (face relative to patch), of any length > 0 and orthogonal to the joint's other directions.
    pub direction: [f64; 3],
    /// The joint's law; without one the joint slides freely.
    pub law: Option<Law>,
}

impl fmt::Debug for Slip {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let law = self.law.as_ref().map(|law| (law.initial_stiffness(), law.slip_force()));
        f.debug_struct("Slip").field("direction", &self.direction).field("k_t, f_s", &law).finish()
    }
}

/// What the nodes of a joint's face follow.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interface {
    /// The whole face follows one rigid motion of the patch: one slip per direction for the whole joint.
    Whole(Patch),
    /// Each node of the face follows the patch's node at the same place: one slip per direction and node, each with the whole law.
    NodeToNode,
    /// As with [`NodeToNode`](Self::NodeToNode), but the nodes are tied in no direction: the law acts between their displacements along the
    /// slips, which must be x, y or z. This is for structures that connect the nodes in the other directions by other means.
    Directions,
}

/// A bolted interface: a face follows a patch except for the slips. All other motions, including drilling rotation, are tied. A joint
/// without slips is a tie.
#[derive(Debug, Clone)]
pub struct Joint {
    /// Name, used in errors and results.
    pub name: String,
    /// The node set that follows.
    pub face: String,
    /// The node set that is followed.
    pub patch: String,
    /// How the face follows the patch.
    pub interface: Interface,
    /// Directions of slip, at most three.
    pub slips: Vec<Slip>,
}

impl Joint {
    /// A tie of the node set `face` to the node set `patch`; [`slip`](Self::slip) makes it a joint.
    #[must_use]
    pub fn new(
        name: impl Into<String>,
        face: impl Into<String>,
        patch: impl Into<String>,
        interface: Interface,
    ) -> Self {
        Self { name: name.into(), face: face.into(), patch: patch.into(), interface, slips: Vec::new() }
    }

    /// The joint with one more direction of slip and its law; with `None` it slides freely.
    #[must_use]
    pub fn slip(mut self, direction: [f64; 3], law: Option<Law>) -> Self {
        self.slips.push(Slip { direction, law });
        self
    }
}
