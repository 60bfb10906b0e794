//! A structure: mesh, materials and what connects its parts.

use std::fmt;
use std::sync::Arc;

use iwan_core::Backbone;

use crate::element::{Formulation, Inertia};
use crate::error::{Error, check};
use crate::material::Material;
use crate::mesh::Mesh;

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

/// Nodes that do not move in some of the directions x, y, z.
#[derive(Debug, Clone, PartialEq)]
pub struct Support {
    /// Name, for errors.
    pub name: String,
    /// Node set.
    pub nodes: String,
    /// Which of x, y, z are fixed.
    pub fixed: [bool; 3],
}

/// A mass or a spring to the ground, shared equally by the nodes of a set.
#[derive(Debug, Clone, PartialEq)]
pub struct Lump {
    /// Name, for errors.
    pub name: String,
    /// Node set.
    pub nodes: String,
    /// Total mass >= 0, the same in all directions.
    pub mass: f64,
    /// Total stiffness >= 0 to the ground in x, y and z.
    pub stiffness: [f64; 3],
}

/// Mesh, materials, joints, supports and lumps: all that the matrices need.
///
/// ```
/// use iwan_fem::mesh::block::{block, uniform};
/// use iwan_fem::{Material, Structure};
/// let mesh = block(&[uniform(0.0, 4.0, 4), uniform(0.0, 1.0, 1), uniform(0.0, 1.0, 1)]);
/// let structure = Structure::new(mesh, Material::new(28.0e6, 0.29, 7.48e-4)?);
/// assert!((structure.assemble()?.total_mass() - 4.0 * 7.48e-4).abs() < 1e-15);
/// # Ok::<(), iwan_fem::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Structure {
    /// The mesh.
    pub mesh: Mesh,
    /// Material of all elements that no entry of `materials` claims.
    pub material: Material,
    /// Materials of element sets; where sets overlap the later entry holds.
    pub materials: Vec<(String, Material)>,
    /// Formulation of eight-node hexahedra.
    pub formulation: Formulation,
    /// Consistent or lumped mass.
    pub inertia: Inertia,
    /// Joints and ties.
    pub joints: Vec<Joint>,
    /// Supports.
    pub supports: Vec<Support>,
    /// Masses and springs at nodes.
    pub lumps: Vec<Lump>,
}

impl Structure {
    /// A structure of one material, free in space; the public fields take what else there is.
    #[must_use]
    pub fn new(mesh: Mesh, material: Material) -> Self {
        Self {
            mesh,
            material,
            materials: Vec::new(),
            formulation: Formulation::default(),
            inertia: Inertia::default(),
            joints: Vec::new(),
            supports: Vec::new(),
            lumps: Vec::new(),
        }
    }

    /// Nodes of a set, with an error that says who asked.
    pub(crate) fn nodes(&self, user: &str, name: &str) -> Result<&[usize], Error> {
        let sets = &self.mesh.node_sets;
        sets.get(name).map(Vec::as_slice).ok_or_else(|| missing(user, "node", name, sets.keys()))
    }

    /// Material of each element.
    pub(crate) fn element_materials(&self) -> Result<Vec<Material>, Error> {
        let mut of = vec![self.material; self.mesh.elements.len()];
        let sets = &self.mesh.element_sets;
        for (name, material) in &self.materials {
            let set = sets.get(name).ok_or_else(|| missing("a material", "element", name, sets.keys()))?;
            for &e in set {
                of[e] = *material;
            }
        }
        Ok(of)
    }

    /// Checks the numbers of lumps.
    pub(crate) fn check_lumps(&self) -> Result<(), Error> {
        for lump in &self.lumps {
            check("lumped mass", lump.mass, lump.mass >= 0.0, "must be a finite number >= 0")?;
            for k in lump.stiffness {
                check("lumped stiffness", k, k >= 0.0, "must be a finite number >= 0")?;
            }
        }
        Ok(())
    }
}

fn missing<'a>(user: &str, kind: &'static str, name: &str, known: impl Iterator<Item = &'a String>) -> Error {
    let known = known.map(String::as_str).collect::<Vec<_>>().join(", ");
    Error::MissingSet { user: user.to_owned(), kind, name: name.to_owned(), known }
}
