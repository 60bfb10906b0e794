//! Equations for combinations of rows of given matrices: recovered displacements, and joints between rows.

use super::elimination::{Equations, Source};
use super::joint_equations::{SlipUnknown, Slips};
use super::unknowns::{Place, Unknown};
use crate::algebra::Site;
use crate::error::Error;
use crate::mesh::Mesh;
use crate::structure::{Given, Row};

/// The terms of a combination; none if it refers to rows that do not exist or has coefficients that are not finite.
fn sources(dofs: &[usize], terms: &[(usize, f64)]) -> Option<Vec<(Source, f64)>> {
    let source =
        |&(row, c): &(usize, f64)| Some((Source::Displacement(*dofs.get(row)?), c)).filter(|_| c.is_finite());
    terms.iter().map(source).collect()
}

fn refused(name: &str, finding: &str) -> Error {
    let remedy = "give one finite coefficient for rows that the matrices have, and not all of them 0";
    Error::Connection { name: name.into(), finding: finding.into(), remedy }
}

/// Writes the equations of recovered displacements, then those of joints between rows. The latter are counted after the `joints` between
/// node sets.
pub(super) fn connect(
    equations: &mut Equations<'_>,
    slips: &mut Slips,
    given: &Given,
    joints: usize,
) -> Result<(), Error> {
    recover(equations, given)?;
    slip(equations, slips, given, joints)
}

/// Makes recovered displacements follow the rows: u = Σ c x.
fn recover(equations: &mut Equations<'_>, given: &Given) -> Result<(), Error> {
    equations.owner("the recovery matrix".into());
    let dofs = given.freedoms(equations.mesh().positions.len());
    for recovered in &given.recovered {
        let terms = sources(&dofs, &recovered.terms).ok_or_else(|| {
            refused("the recovery matrix", "it has a column without a row, or a number that is not finite")
        })?;
        equations.set(recovered.node, recovered.axis, terms)?;
    }
    Ok(())
}

/// Makes each slip s = Σ c x an unknown in place of one of its rows: the row with the largest coefficient among those that nothing else
/// determines.
fn slip(equations: &mut Equations<'_>, slips: &mut Slips, given: &Given, joints: usize) -> Result<(), Error> {
    let dofs = given.freedoms(equations.mesh().positions.len());
    for (index, slip) in given.relative.iter().enumerate() {
        let name = format!("joint `{}`", slip.name);
        let mut terms = sources(&dofs, &slip.terms)
            .filter(|terms| terms.iter().any(|(_, c)| *c != 0.0))
            .ok_or_else(|| {
                refused(&name, "its row is all 0, has a column without a row, or a number that is not finite")
            })?;
        let at = place(equations, given, &slip.terms);
        let source = equations.add_extra(Unknown::Slip { slip: slips.len() }, at);
        let unknown = equations.extra.len() - 1;
        let joint = joints + index;
        slips.push(SlipUnknown { name: slip.name.clone(), joint, unknown, law: slip.law.clone() });
        terms.push((source, -1.0));
        equations.owner(name);
        equations.equation(&terms, &[])?;
    }
    Ok(())
}

/// Sets the slips between rows for a rigid motion of the whole structure. They are zero, except for slips to the ground and slips between
/// unconnected parts.
pub(super) fn move_slips(given: &Given, mesh: &Mesh, slips: &[SlipUnknown], motion: usize, into: &mut [f64]) {
    let first = slips.len() - given.relative.len();
    let seen = |&(row, c): &(usize, f64)| {
        let (unknown, node) = match given.rows[row] {
            Row::Displacement { node, axis } => (Unknown::Displacement { node, axis }, node),
            Row::Rotation { node, axis } => (Unknown::Rotation { node, axis }, node),
            Row::Generalised => return 0.0,
        };
        let site = Site { position: mesh.positions[node], group: 0 };
        c * Place { unknown, site }.rigid(motion, [0.0; 3])
    };
    for (slip, relative) in slips[first..].iter().zip(&given.relative) {
        into[slip.unknown] = relative.terms.iter().map(seen).sum();
    }
}

/// Position of a slip: the mean position of the nodes whose displacements it compares.
fn place(equations: &Equations<'_>, given: &Given, terms: &[(usize, f64)]) -> [f64; 3] {
    let node = |&(row, _): &(usize, f64)| match given.rows[row] {
        Row::Displacement { node, .. } | Row::Rotation { node, .. } => Some(node),
        Row::Generalised => None,
    };
    let nodes: Vec<usize> = terms.iter().filter_map(node).collect();
    let share = 1.0 / nodes.len().max(1) as f64;
    let positions = &equations.mesh().positions;
    nodes.iter().fold([0.0; 3], |sum, &n| std::array::from_fn(|a| sum[a] + share * positions[n][a]))
}
