//! Ten-node tetrahedron: linear strain.
//!
//! ```text
//!          3
//!        / | \         corners 0-3 as in the four-node element,
//!       7  9  8        4-6 in the middle of the bottom edges 0-1, 1-2, 2-0,
//!      /   2   \       7-9 in that of the edges 0-3, 1-3, 2-3
//!     / 6     5 \
//!    0-----4-----1
//! ```
//!
//! With the barycentric coordinates L: N = L(2L - 1) at corners and 4 L_a L_b in the middle of edge a-b; integrated with four points (O. C.
//! Zienkiewicz and R. L. Taylor, The Finite Element Method, Vol. 1, Sec. 8.12).

use super::geometry::NoVolume;
use super::material::Material;
use super::rules::{TETRAHEDRON_4, integrate};
use super::tet4;
use crate::mesh::Shape;

/// N_i and ∂N_i/∂ξ_a at a point of the reference tetrahedron.
pub(super) fn functions(at: [f64; 3]) -> ([f64; 10], [[f64; 3]; 10]) {
    let (l, slopes) = tet4::functions(at);
    let (mut values, mut derivatives) = ([0.0; 10], [[0.0; 3]; 10]);
    for i in 0..4 {
        values[i] = l[i] * (2.0 * l[i] - 1.0);
        derivatives[i] = slopes[i].map(|slope| (4.0 * l[i] - 1.0) * slope);
    }
    for (i, &(a, b)) in (4..).zip(Shape::Tet10.edges()) {
        values[i] = 4.0 * l[a] * l[b];
        derivatives[i] = std::array::from_fn(|k| 4.0 * (l[a] * slopes[b][k] + l[b] * slopes[a][k]));
    }
    (values, derivatives)
}

/// Stiffness (30 x 30) and mass (10 x 10).
pub(super) fn matrices(
    material: &Material,
    positions: &[[f64; 3]],
    out: (&mut [f64], &mut [f64]),
) -> Result<(), NoVolume> {
    integrate(TETRAHEDRON_4, functions, material, positions, out)
}

#[cfg(test)]
mod tests {
    use super::super::rules::assert_interpolation;
    use super::*;

    #[test]
    fn shape_functions_interpolate() {
        let nodes = std::array::from_fn(|i| match i.checked_sub(4).map(|edge| Shape::Tet10.edges()[edge]) {
            None => tet4::CORNERS[i],
            Some((a, b)) => std::array::from_fn(|k| 0.5 * (tet4::CORNERS[a][k] + tet4::CORNERS[b][k])),
        });
        assert_interpolation(functions, &nodes);
    }
}
