//! A structure: mesh, materials, what connects its parts and what holds it.

use super::given::Given;
use super::interface::Joint;
use crate::element::{Formulation, Inertia, Material};
use crate::error::{Error, check};
use crate::mesh::Mesh;

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
    /// Stiffness and mass from another program. With them the elements of the mesh serve pictures only, and materials nothing.
    pub given: Option<Given>,
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
            given: None,
        }
    }

    /// Nodes of a set, with an error that says who asked.
    pub(crate) fn nodes(&self, user: &str, name: &str) -> Result<&[usize], Error> {
        let sets = &self.mesh.node_sets;
        sets.get(name).map(Vec::as_slice).ok_or_else(|| missing(user, "node", name, sets.keys()))
    }

    /// Material of each element.
    pub(crate) fn element_materials(&self) -> Result<Vec<Material>, Error> {
        let mut materials = vec![self.material; self.mesh.elements.len()];
        let sets = &self.mesh.element_sets;
        for (name, material) in &self.materials {
            let set = sets.get(name).ok_or_else(|| missing("a material", "element", name, sets.keys()))?;
            for &e in set {
                materials[e] = *material;
            }
        }
        Ok(materials)
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
