//! Matrices from another program, transformed to the unknowns.

use super::elimination::Transformation;
use crate::algebra::Symmetric;
use crate::structure::Given;

/// The given matrices in terms of the unknowns.
pub(super) struct InUnknowns {
    pub(super) stiffness: Symmetric,
    pub(super) mass: Symmetric,
    pub(super) damping: Option<Symmetric>,
}

/// The given matrices in the unknowns: Tᵀ K T, Tᵀ M T and Tᵀ C T.
pub(super) fn assemble(nodes: usize, given: &Given, transformation: &Transformation) -> InUnknowns {
    let dofs = given.freedoms(nodes);
    let into = |matrix: &Symmetric| {
        let mut entries = Vec::with_capacity(matrix.stored());
        for (i, j, value) in matrix.lower() {
            let (rows, columns) = (transformation.row(dofs[i]), transformation.row(dofs[j]));
            for &(p, c) in rows {
                for &(q, d) in columns {
                    // An entry off the diagonal stands for two; if both displacements depend on one unknown, the two are added at one
                    // place.
                    let twice = if i != j && p == q { 2.0 } else { 1.0 };
                    if i != j || q <= p {
                        entries.push((p.max(q), p.min(q), twice * c * d * value));
                    }
                }
            }
        }
        Symmetric::from_lower(transformation.places.len(), entries)
    };
    InUnknowns {
        stiffness: into(&given.stiffness),
        mass: into(&given.mass).without_zeros(),
        damping: given.damping.as_ref().map(into),
    }
}
