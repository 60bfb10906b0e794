//! A structure: mesh, materials, the connections of its parts, and its supports.

use iwan_machine::listed;
use std::sync::Arc;

use super::given::Given;
use super::interface::Joint;
use super::kept::Kept;
use crate::element::{Formulation, Inertia, Material};
use crate::error::{Error, check};
use crate::mesh::{Constraint, Mesh, PointMass, Sides};

/// A support: nodes that do not move in some of the directions x, y, z.
#[derive(Debug, Clone, PartialEq)]
pub struct Support {
    /// Name, for error messages.
    pub name: String,
    /// Node set.
    pub nodes: String,
    /// Which of x, y, z are fixed.
    pub fixed: [bool; 3],
}

/// A mass or a spring to the ground, distributed equally over the nodes of a set.
#[derive(Debug, Clone, PartialEq)]
pub struct Lump {
    /// Name, for error messages.
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
    /// Material of all elements that are in no set of `materials`.
    pub material: Material,
    /// Materials of element sets; where sets overlap, the later entry applies.
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
    /// Constraints of the mesh file.
    pub constraints: Vec<Constraint>,
    /// Masses with inertia at nodes.
    pub masses: Vec<PointMass>,
    /// Stiffness and mass from another program. With them the elements of the mesh are used for pictures only, and materials are not used.
    pub given: Option<Given>,
    /// Modes and a reduced basis from an earlier run, used instead of factorisations.
    pub kept: Option<Arc<Kept>>,
}

impl Structure {
    /// A structure of one material, free in space; further properties are set in the public fields.
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
            constraints: Vec::new(),
            masses: Vec::new(),
            given: None,
            kept: None,
        }
    }

    /// Ties the nodes of the set `face` to the outer faces of the mesh whose corners all belong to the set `patch`. Each node is moved to
    /// the nearest point of a face and then follows that point. The meshes need not match. Nodes farther from all faces than `tolerance`
    /// (length) stay free; the default is a twentieth of the faces' mean size. Returns the largest distance by which a node was moved, and
    /// the number of nodes that stay free.
    ///
    /// # Errors
    /// [`Error::MissingSet`]; [`Error::Connection`] if the patch has no faces or no node is near them.
    ///
    /// ```
    /// use iwan_fem::mesh::block::{block, uniform};
    /// use iwan_fem::{Material, Structure};
    /// // Two blocks on top of each other, 2 x 2 elements on 3 x 3.
    /// let mut mesh = block(&[uniform(0.0, 1.0, 3), uniform(0.0, 1.0, 3), uniform(0.0, 1.0, 1)]);
    /// let upper = block(&[uniform(0.0, 1.0, 2), uniform(0.0, 1.0, 2), uniform(1.0, 2.0, 1)]);
    /// let nodes = mesh.positions.len();
    /// mesh.positions.extend(upper.positions);
    /// mesh.node_labels.extend(upper.node_labels.iter().map(|label| label + 100));
    /// mesh.elements.extend(upper.elements.into_iter().map(|mut element| {
    ///     element.label += 100;
    ///     element.nodes.iter_mut().for_each(|node| *node += nodes);
    ///     element
    /// }));
    /// let at = |z: f64, range: std::ops::Range<usize>| range.filter(|n| mesh.positions[*n][2] == z).collect::<Vec<_>>();
    /// let (below, above) = (at(1.0, 0..nodes), at(1.0, nodes..mesh.positions.len()));
    /// mesh.node_sets.insert("below".into(), below);
    /// mesh.node_sets.insert("above".into(), above);
    /// let mut structure = Structure::new(mesh, Material::new(1.0, 0.3, 1.0)?);
    /// let (moved, free) = structure.project("glue", "above", "below", None)?;
    /// assert!(moved < 1e-12 && free == 0);
    /// assert!(structure.check().message().is_none());
    /// # Ok::<(), iwan_fem::Error>(())
    /// ```
    pub fn project(
        &mut self,
        name: &str,
        face: &str,
        patch: &str,
        tolerance: Option<f64>,
    ) -> Result<(f64, usize), Error> {
        let user = format!("tie `{name}`");
        let faces = self.mesh.faces_within(self.nodes(&user, patch)?);
        let nodes = self.nodes(&user, face)?.to_vec();
        let refused = |finding: String, remedy| Error::Connection { name: user.clone(), finding, remedy };
        if faces.is_empty() {
            let finding = format!("no outer face of the mesh has all its corners in the set `{patch}`");
            return Err(refused(finding, "name the set of all nodes of a face of the part"));
        }
        let tied = self.mesh.tie(Sides { name: &user, nodes: &nodes, faces: &faces, tolerance });
        if tied.constraints.is_empty() {
            let finding = format!("none of its {} nodes is near the faces of `{patch}`", nodes.len());
            return Err(refused(finding, "name sets that face each other, or give a larger tolerance"));
        }
        for (node, position) in &tied.feet {
            self.mesh.positions[*node] = *position;
        }
        self.constraints.extend(tied.constraints);
        Ok((tied.gap, tied.free.len()))
    }

    /// Nodes of a set; the error for a missing set names `user`, the item that refers to it.
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

    /// Checks the values of lumps and point masses.
    pub(crate) fn check_lumps(&self) -> Result<(), Error> {
        for lump in &self.lumps {
            check("lumped mass", lump.mass, lump.mass >= 0.0, "must be a finite number >= 0")?;
            for k in lump.stiffness {
                check("lumped stiffness", k, k >= 0.0, "must be a finite number >= 0")?;
            }
        }
        for mass in &self.masses {
            check("mass at a node", mass.mass, mass.mass >= 0.0, "must be a finite number >= 0")?;
            for value in mass.offset.iter().chain(mass.inertia.as_flattened()) {
                check("offset or inertia of a mass at a node", *value, true, "must be finite")?;
            }
        }
        Ok(())
    }
}

fn missing<'a>(user: &str, kind: &'static str, name: &str, known: impl Iterator<Item = &'a String>) -> Error {
    Error::MissingSet { user: user.to_owned(), kind, name: name.to_owned(), known: listed(known) }
}
