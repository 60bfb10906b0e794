//! Eight-node hexahedron, with displacements only.
//!
//! ```text
//!          7--------6        ζ
//!         /|       /|        |  η
//!        4--------5 |        | /
//!        | 3------|-2        |/____ ξ
//!        |/       |/
//!        0--------1      -1 <= ξ, η, ζ <= 1
//! ```
//!
//! N_i = (1 + ξ_i ξ)(1 + η_i η)(1 + ζ_i ζ)/8, integrated with 2 x 2 x 2 points. The element locks in bending; it is that of T. J. R.
//! Hughes, The Finite Element Method, 1987, Sec. 3.5.

use super::geometry::{Jacobian, NoVolume, TWO, points};
use super::isotropic::{GradientProducts, add_mass};
use super::material::Material;

/// Corners of the reference cube.
pub(super) const CORNERS: [[f64; 3]; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];

/// N_i at a point of the reference cube.
pub(super) fn shape_functions(at: [f64; 3]) -> [f64; 8] {
    CORNERS.map(|c| 0.125 * (1.0 + c[0] * at[0]) * (1.0 + c[1] * at[1]) * (1.0 + c[2] * at[2]))
}

/// ∂N_i/∂ξ_a at a point of the reference cube.
pub(super) fn derivatives(at: [f64; 3]) -> [[f64; 3]; 8] {
    CORNERS.map(|c| {
        let f: [f64; 3] = std::array::from_fn(|a| 1.0 + c[a] * at[a]);
        [0.125 * c[0] * f[1] * f[2], 0.125 * c[1] * f[0] * f[2], 0.125 * c[2] * f[0] * f[1]]
    })
}

/// Stiffness (24 x 24) and mass (8 x 8).
pub(super) fn matrices(
    material: &Material,
    positions: &[[f64; 3]],
    (stiffness, mass): (&mut [f64], &mut [f64]),
) -> Result<(), NoVolume> {
    let mut products = GradientProducts::<8>::new();
    for (point, (at, weight)) in points(&TWO).enumerate() {
        let d = derivatives(at);
        let jacobian = Jacobian::new(&d, positions, point + 1)?;
        products.add(&d.map(|d| jacobian.gradient(d)), weight * jacobian.determinant);
        add_mass(&shape_functions(at), material.density() * weight * jacobian.determinant, mass);
    }
    products.stiffness(material, stiffness);
    Ok(())
}
