//! Four-node tetrahedron: constant strain.
//!
//! ```text
//!        3
//!       /|\            ζ
//!      / | \           |  η
//!     /  2  \          | /
//!    / /   \ \         |/____ ξ
//!    0---------1       ξ, η, ζ >= 0, ξ + η + ζ <= 1
//! ```
//!
//! N = (1 - ξ - η - ζ, ξ, η, ζ), integrated with one point (T. J. R. Hughes, The Finite Element Method, 1987, App. 3.I). The element is
//! much too stiff in bending and for nearly incompressible material; the check of a mesh with such elements makes a remark.

use super::geometry::NoVolume;
use super::material::Material;
use super::rules::{TETRAHEDRON_1, integrate};

/// Corners of the reference tetrahedron.
pub(super) const CORNERS: [[f64; 3]; 4] =
    [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// ∂N_i/∂ξ_a, which are constant.
pub(super) const SLOPES: [[f64; 3]; 4] =
    [[-1.0, -1.0, -1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// N_i, which are the barycentric coordinates, and ∂N_i/∂ξ_a.
pub(super) fn functions([x, y, z]: [f64; 3]) -> ([f64; 4], [[f64; 3]; 4]) {
    ([1.0 - x - y - z, x, y, z], SLOPES)
}

/// Stiffness (12 x 12) and mass (4 x 4).
pub(super) fn matrices(
    material: &Material,
    positions: &[[f64; 3]],
    out: (&mut [f64], &mut [f64]),
) -> Result<(), NoVolume> {
    integrate(TETRAHEDRON_1, functions, material, positions, out)
}

#[cfg(test)]
mod tests {
    use super::super::rules::assert_interpolation;

    #[test]
    fn shape_functions_interpolate() {
        assert_interpolation(super::functions, &super::CORNERS);
    }
}
