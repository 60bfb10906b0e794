//! Point masses at nodes, with inertia where the node has rotations.

use std::collections::BTreeMap;

use super::constraint_equations::Rotations;
use super::elimination::Transformation;
use crate::algebra::Symmetric;
use crate::error::Error;
use crate::mesh::{Freedom, PointMass};
use crate::structure::Structure;

/// Returns the mass with all point masses added, and the stiffness with zeros at the same places, because both are factored on the pattern
/// of the stiffness.
pub(crate) fn add(
    structure: &Structure,
    rotations: &Rotations,
    transformation: &Transformation,
    stiffness: Symmetric,
    mass: Symmetric,
) -> Result<(Symmetric, Symmetric), Error> {
    if structure.masses.is_empty() {
        return Ok((stiffness, mass));
    }
    let mut entries = BTreeMap::new();
    for body in &structure.masses {
        let dof = |component| rotations.dof(Freedom { node: body.node, component });
        let dofs: Vec<usize> = (0..6).filter_map(dof).collect();
        if dofs.len() < 6 && body.offset.iter().chain(body.inertia.as_flattened()).any(|x| *x != 0.0) {
            return Err(Error::Connection {
                name: body.name.clone(),
                finding: format!(
                    "it has inertia or an offset, but its node {} has no rotations",
                    structure.mesh.node_labels[body.node]
                ),
                remedy: "put it at the reference node of a rigid body or coupling, or give the mass alone",
            });
        }
        let matrix = matrix(body);
        for (a, &p) in dofs.iter().enumerate() {
            for (b, &q) in dofs.iter().enumerate() {
                for &(i, c) in transformation.row(p) {
                    for &(j, d) in transformation.row(q).iter().filter(|term| term.0 <= i) {
                        *entries.entry((j, i)).or_insert(0.0) += matrix[a][b] * c * d;
                    }
                }
            }
        }
    }
    let added = Symmetric::from_entries(mass.order(), &entries);
    Ok((stiffness.plus(0.0, &added), mass.plus(1.0, &added).without_zeros()))
}

/// Mass matrix for displacements and rotations of the node; with the offset e, the centre of mass moves by u + θ x e.
fn matrix(body: &PointMass) -> [[f64; 6]; 6] {
    let [x, y, z] = body.offset;
    // u + θ x e = u + E θ.
    let e = [[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]];
    let mut matrix = [[0.0; 6]; 6];
    for a in 0..3 {
        matrix[a][a] = body.mass;
        for b in 0..3 {
            matrix[a][3 + b] = body.mass * e[a][b];
            matrix[3 + b][a] = matrix[a][3 + b];
            let steiner: f64 = (0..3).map(|k| e[k][a] * e[k][b]).sum();
            matrix[3 + a][3 + b] = body.inertia[a][b] + body.mass * steiner;
        }
    }
    matrix
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Kinetic energy of a rotating body: that of its own inertia, and that of its mass on a circle.
    #[test]
    fn an_offset_adds_steiners_part() {
        let body = PointMass {
            name: "m".into(),
            node: 0,
            mass: 2.0,
            offset: [3.0, 0.0, 0.0],
            inertia: [[0.5, 0.0, 0.0], [0.0, 0.6, 0.0], [0.0, 0.0, 0.7]],
        };
        let m = matrix(&body);
        assert_eq!((m[3][3], m[4][4], m[5][5]), (0.5, 0.6 + 18.0, 0.7 + 18.0));
        // A rotation about z with unit speed moves the centre of mass along y with speed 3.
        assert_eq!((m[1][5], m[2][4], m[5][1]), (6.0, -6.0, 6.0));
    }
}
