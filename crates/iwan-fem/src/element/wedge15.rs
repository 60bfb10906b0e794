//! Fifteen-node wedge (serendipity).
//!
//! ```text
//!       3---11--5
//!       | 9  10 |       corners 0-5 as in the six-node element,
//!      12   4   14      6-8 in the middle of the bottom edges 0-1, 1-2, 2-0,
//!       |   |   |       9-11 in that of the top edges, 12-14 in that of the upright ones
//!       0--8|---2
//!        6  13  7
//!           1
//! ```
//!
//! N = L[(2L - 1)(1 ± ζ) - (1 - ζ²)]/2 at corners, 2 L_a L_b (1 ± ζ) in the middle of the edges of the triangles, L(1 - ζ²) in that of the
//! upright ones (O. C. Zienkiewicz and R. L. Taylor, The Finite Element Method, Vol. 1, Sec. 8.13); nine points, as in CalculiX's C3D15.

use super::geometry::NoVolume;
use super::material::Material;
use super::rules::{WEDGE_9, integrate};
use super::wedge6::SLOPES;

/// Corners of the triangle at the ends of its edges.
const EDGES: [(usize, usize); 3] = [(0, 1), (1, 2), (2, 0)];

/// N_i and ∂N_i/∂ξ_a at a point of the reference wedge.
pub(super) fn functions([x, y, z]: [f64; 3]) -> ([f64; 15], [[f64; 3]; 15]) {
    let l = [1.0 - x - y, x, y];
    let bubble = 1.0 - z * z;
    let (mut values, mut derivatives) = ([0.0; 15], [[0.0; 3]; 15]);
    for i in 0..3 {
        for (top, side) in [(0, -1.0), (1, 1.0)] {
            let rise = 1.0 + side * z;
            let corner = i + 3 * top;
            values[corner] = 0.5 * l[i] * ((2.0 * l[i] - 1.0) * rise - bubble);
            let by_l = 0.5 * ((4.0 * l[i] - 1.0) * rise - bubble);
            let by_z = 0.5 * l[i] * ((2.0 * l[i] - 1.0) * side + 2.0 * z);
            derivatives[corner] = [by_l * SLOPES[i][0], by_l * SLOPES[i][1], by_z];
            let ((a, b), middle) = (EDGES[i], 6 + i + 3 * top);
            values[middle] = 2.0 * l[a] * l[b] * rise;
            let slope = |k: usize| 2.0 * (l[a] * SLOPES[b][k] + l[b] * SLOPES[a][k]) * rise;
            derivatives[middle] = [slope(0), slope(1), 2.0 * l[a] * l[b] * side];
        }
        values[12 + i] = l[i] * bubble;
        derivatives[12 + i] = [SLOPES[i][0] * bubble, SLOPES[i][1] * bubble, -2.0 * z * l[i]];
    }
    (values, derivatives)
}

/// Stiffness (45 x 45) and mass (15 x 15).
pub(super) fn matrices(
    material: &Material,
    positions: &[[f64; 3]],
    out: (&mut [f64], &mut [f64]),
) -> Result<(), NoVolume> {
    integrate(WEDGE_9, functions, material, positions, out)
}

#[cfg(test)]
mod tests {
    use super::super::rules::assert_interpolation;
    use super::super::wedge6::CORNERS;
    use crate::mesh::Shape;

    #[test]
    fn shape_functions_interpolate() {
        let edges = Shape::Wedge15.edges();
        let nodes = std::array::from_fn(|i| match i.checked_sub(6).map(|edge| edges[edge]) {
            None => CORNERS[i],
            Some((a, b)) => std::array::from_fn(|k| 0.5 * (CORNERS[a][k] + CORNERS[b][k])),
        });
        assert_interpolation(super::functions, &nodes);
    }
}
