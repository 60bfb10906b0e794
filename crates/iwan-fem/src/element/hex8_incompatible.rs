//! Eight-node hexahedron with incompatible modes, which bends without locking.
//!
//! ```text
//!      ____                  u = Σ N_i u_i + (1 - ξ²) a_1 + (1 - η²) a_2 + (1 - ζ²) a_3
//!     /    \    bending
//!    |      |   needs 1 - ξ²: nine internal unknowns a, condensed in the element
//! ```
//!
//! E. L. Wilson et al., Incompatible displacement models, 1973; R. L. Taylor, P. J. Beresford and E. L. Wilson, Int. J. Numer. Meth. Eng.
//! 10:1211, 1976, doi:10.1002/nme.1620100602 (QM6). The gradients of the internal modes use the Jacobian at the centre, scaled by j_0/j, so
//! that a constant stress does no work on them and distorted elements pass the patch test. The internal modes carry no inertia.

use super::geometry::{Jacobian, NoVolume, TWO, points};
use super::hex8;
use super::isotropic::{GradientProducts, add_mass};
use super::material::Material;

/// Number of functions: eight of the nodes and three internal ones.
const FUNCTIONS: usize = 11;
/// Number of displacement unknowns of the nodes.
const OUTER: usize = 24;
/// Number of these and the internal unknowns together.
const ALL: usize = 33;

/// Stiffness (24 x 24) and mass (8 x 8).
pub(super) fn matrices(
    material: &Material,
    positions: &[[f64; 3]],
    (stiffness, mass): (&mut [f64], &mut [f64]),
) -> Result<(), NoVolume> {
    let centre = Jacobian::new(&hex8::derivatives([0.0; 3]), positions, 0)?;
    let mut products = GradientProducts::<FUNCTIONS>::new();
    for (point, (at, weight)) in points(&TWO).enumerate() {
        let d = hex8::derivatives(at);
        let jacobian = Jacobian::new(&d, positions, point + 1)?;
        let scale = -2.0 * centre.determinant / jacobian.determinant;
        let gradients = std::array::from_fn(|i| {
            if i < 8 {
                return jacobian.gradient(d[i]);
            }
            let mut internal = [0.0; 3];
            internal[i - 8] = scale * at[i - 8];
            centre.gradient(internal)
        });
        products.add(&gradients, weight * jacobian.determinant);
        add_mass(&hex8::shape_functions(at), material.density() * weight * jacobian.determinant, mass);
    }
    let mut full = [0.0; ALL * ALL];
    products.stiffness(material, &mut full);
    condense(&mut full);
    for (out, row) in stiffness.chunks_exact_mut(OUTER).zip(full.chunks_exact(ALL)) {
        out.copy_from_slice(&row[..OUTER]);
    }
    Ok(())
}

/// Eliminates the internal unknowns, the last one first; K_uu - K_ua K_aa⁻¹ K_au remains in the leading block.
///
/// K_aa is positive definite for any admissible material and volume, so no pivoting is needed.
fn condense(k: &mut [f64; ALL * ALL]) {
    for last in (OUTER..ALL).rev() {
        let pivot: [f64; ALL] = std::array::from_fn(|j| k[last * ALL + j]);
        for i in 0..last {
            let factor = pivot[i] / pivot[last];
            let row = &mut k[i * ALL..i * ALL + last];
            row.iter_mut().zip(&pivot).for_each(|(entry, p)| *entry -= factor * p);
        }
    }
}
