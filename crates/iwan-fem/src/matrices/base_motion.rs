//! Inertia forces under an acceleration of the base, that is of supports and of the ground ends of springs.

use std::collections::HashMap;

use super::assembly::Assembled;
use super::constraint_equations::Rotations;
use super::unknowns::Unknown;
use crate::algebra::add_scaled;
use crate::error::{Error, check};
use crate::mesh::{Freedom, Rule};
use crate::structure::Row;

/// Place of a motion in the equations.
#[derive(Debug, Clone, Copy)]
enum At {
    /// A row of T.
    Freedom(usize),
    /// An unknown that belongs to no node.
    Unknown(usize),
}

impl Assembled {
    /// Forces on the unknowns, which are relative to the base, when the base is accelerated by 1 along `direction` (x, y, z; its length
    /// counts): -Tᵀ M ι. ι is the rigid motion of the whole structure with its base. It includes the supported nodes, because their
    /// consistent mass also acts on their neighbours.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a direction that is not finite or has no length.
    ///
    /// ```
    /// use iwan_fem::mesh::block::{block, uniform};
    /// use iwan_fem::{Material, Structure, Support};
    /// // A bar of 4 elements and the mass 4, held at one end.
    /// let mesh = block(&[uniform(0.0, 4.0, 4), uniform(0.0, 1.0, 1), uniform(0.0, 1.0, 1)]);
    /// let mut structure = Structure::new(mesh, Material::new(1.0, 0.3, 1.0)?);
    /// let end = (0..structure.mesh.positions.len()).filter(|n| structure.mesh.positions[*n][0] == 0.0).collect();
    /// structure.mesh.node_sets.insert("end".into(), end);
    /// structure.supports.push(Support { name: "wall".into(), nodes: "end".into(), fixed: [true; 3] });
    /// let assembled = structure.assemble()?;
    /// let force = assembled.base_force([1.0, 0.0, 0.0])?;
    /// // Half of the mass of the element at the wall is carried by the wall directly.
    /// assert!((force.iter().sum::<f64>() + 3.5).abs() < 1e-12);
    /// # Ok::<(), iwan_fem::Error>(())
    /// ```
    pub fn base_force(&self, direction: [f64; 3]) -> Result<Vec<f64>, Error> {
        for component in direction {
            check("direction", component, true, "must be finite")?;
        }
        let length = direction.iter().map(|d| d * d).sum::<f64>().sqrt();
        check("length of the direction", length, length > 0.0, "must be > 0")?;
        let mut unheld = self.structure().clone();
        unheld.supports.clear();
        unheld.constraints.retain(|constraint| !matches!(constraint.rule, Rule::Held(_)));
        unheld.kept = None;
        let unheld = unheld.assemble_unheld()?;
        let mut moved = vec![0.0; unheld.unknowns()];
        for (axis, component) in direction.into_iter().enumerate() {
            add_scaled(&mut moved, component, &unheld.rigid_motion(axis));
        }
        let mut out = vec![0.0; self.unknowns()];
        let places = self.freedoms();
        for (j, inertia) in unheld.mass().times(&moved).into_iter().enumerate().filter(|(_, f)| *f != 0.0) {
            match places.get(&unheld.unknown(j)) {
                Some(At::Freedom(dof)) => self.transformation().add_force(*dof, -inertia, &mut out),
                Some(At::Unknown(own)) => out[*own] -= inertia,
                // Not reached: every unknown of the structure without supports belongs to a node, a joint or the matrices, and has a place
                // here too.
                None => {}
            }
        }
        Ok(out)
    }

    /// Total mass.
    #[must_use]
    pub fn total_mass(&self) -> f64 {
        let moved = self.rigid_motion(0);
        self.mass().form(&moved, &moved)
    }

    /// Place of each unknown that the structure may have: a row of T, or, for an unknown that belongs to no node, an unknown.
    fn freedoms(&self) -> HashMap<Unknown, At> {
        let structure = self.structure();
        let nodes = structure.mesh.positions.len();
        let displacement =
            |dof: usize| (Unknown::Displacement { node: dof / 3, axis: dof % 3 }, At::Freedom(dof));
        let mut found: HashMap<Unknown, At> = (0..3 * nodes).map(displacement).collect();
        if let Some(given) = &structure.given {
            for ((row, of), dof) in given.rows.iter().enumerate().zip(given.freedoms(nodes)) {
                let unknown = match *of {
                    Row::Displacement { .. } => continue,
                    Row::Rotation { node, axis } => Unknown::Rotation { node, axis },
                    Row::Generalised => Unknown::Generalised { row },
                };
                found.insert(unknown, At::Freedom(dof));
            }
        } else {
            let rotations = Rotations::new(structure);
            for unknown in rotations.meaning() {
                let Unknown::Rotation { node, axis } = unknown else { continue };
                if let Some(dof) = rotations.dof(Freedom { node, component: 3 + axis }) {
                    found.insert(unknown, At::Freedom(dof));
                }
            }
        }
        for j in 0..self.unknowns() {
            if let unknown @ (Unknown::Reference { .. } | Unknown::Slip { .. }) = self.unknown(j) {
                found.insert(unknown, At::Unknown(j));
            }
        }
        found
    }
}
