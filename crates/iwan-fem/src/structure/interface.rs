//! Bolted interfaces: what follows what, where it slips and by which law.

use std::fmt;
use std::sync::Arc;

use iwan_core::Backbone;

/// A joint law that any number of joints and threads share.
pub type Law = Arc<dyn Backbone + Send + Sync>;

/// How a patch of nodes defines the motion that a washer's face follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Patch {
    /// All nodes of the patch move as one rigid body (RBE2).
    Rigid,
    /// The rigid motion that fits the patch's nodes best, equally weighted; the patch stays flexible (RBE3).
    #[default]
    Averaging,
}

/// A direction in which a joint slips, and its law there.
#[derive(Clone)]
pub struct Slip {
    /// Direction of the slip (face relative to patch); of any length > 0, orthogonal to the joint's other ones.
    pub direction: [f64; 3],
    /// The joint's law; none lets the joint slide freely.
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
    /// The whole face follows one rigid motion of the patch: one slip per direction.
    Whole(Patch),
    /// Each node of the face follows the patch's node at its place: a slip per direction and node, each with the whole law.
    NodeToNode,
    /// As [`NodeToNode`](Self::NodeToNode), but the nodes are tied in no direction: the law acts between their displacements along the slips,
    /// which must be x, y or z. For structures that connect the nodes in the other directions by themselves.
    Directions,
}

/// A bolted interface: a face follows a patch but for the slips; all other motions, drilling included, are tied.
/// Without slips it is a tie.
#[derive(Debug, Clone)]
pub struct Joint {
    /// Name: errors and results carry it.
    pub name: String,
    /// Node set that follows.
    pub face: String,
    /// Node set that is followed.
    pub patch: String,
    /// How.
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

    /// The joint with a further direction of slip and its law; `None` slides freely.
    #[must_use]
    pub fn slip(mut self, direction: [f64; 3], law: Option<Law>) -> Self {
        self.slips.push(Slip { direction, law });
        self
    }
}
