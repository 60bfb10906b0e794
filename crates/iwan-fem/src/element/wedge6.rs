//! Six-node wedge.
//!
//! ```text
//!      3-------5      ζ
//!      |\     /|      |  η
//!      | \ 4 / |      | /
//!      |   |   |      |/____ ξ
//!      0---|---2      ξ, η >= 0, ξ + η <= 1, -1 <= ζ <= 1
//!       \  |  /
//!          1
//! ```
//!
//! N = L(1 - ζ)/2 at the bottom and L(1 + ζ)/2 at the top, L = (1 - ξ - η, ξ, η); integrated with two points on the axis, as in CalculiX's
//! C3D6. The element is meant for filling meshes of hexahedra and tetrahedra; it is stiff in bending like the four-node tetrahedron. A
//! twist of the two triangles about the axis causes no strain on the axis. Therefore one element alone, or a column of single ones, twists
//! freely; where a second element shares an upright face there is no such motion.

use super::geometry::NoVolume;
use super::material::Material;
use super::rules::{WEDGE_2, integrate};

/// Corners of the reference wedge.
pub(super) const CORNERS: [[f64; 3]; 6] =
    [[0.0, 0.0, -1.0], [1.0, 0.0, -1.0], [0.0, 1.0, -1.0], [0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]];
/// ∂L_i/∂ξ and ∂L_i/∂η.
pub(super) const SLOPES: [[f64; 2]; 3] = [[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]];

/// N_i and ∂N_i/∂ξ_a at a point of the reference wedge.
pub(super) fn functions([x, y, z]: [f64; 3]) -> ([f64; 6], [[f64; 3]; 6]) {
    let l = [1.0 - x - y, x, y];
    let (mut values, mut derivatives) = ([0.0; 6], [[0.0; 3]; 6]);
    for i in 0..6 {
        let side = if i < 3 { -1.0 } else { 1.0 };
        let height = 0.5 * (1.0 + side * z);
        values[i] = l[i % 3] * height;
        let [along, across] = SLOPES[i % 3];
        derivatives[i] = [along * height, across * height, 0.5 * side * l[i % 3]];
    }
    (values, derivatives)
}

/// Stiffness (18 x 18) and mass (6 x 6).
pub(super) fn matrices(
    material: &Material,
    positions: &[[f64; 3]],
    out: (&mut [f64], &mut [f64]),
) -> Result<(), NoVolume> {
    integrate(WEDGE_2, functions, material, positions, out)
}

#[cfg(test)]
mod tests {
    use super::super::rules::assert_interpolation;

    #[test]
    fn shape_functions_interpolate() {
        assert_interpolation(super::functions, &super::CORNERS);
    }
}
