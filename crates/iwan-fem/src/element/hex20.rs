//! Twenty-node hexahedron (serendipity), the reference element.
//!
//! ```text
//!          7---14---6
//!        15|      13|
//!        4---12---5 |       corners 0-7 as in the eight-node element,
//!        |19      |18       8-11 in the middle of the bottom edges 0-1, 1-2, 2-3, 3-0,
//!       16 3--10--17|2      12-15 in that of the top edges, 16-19 in that of the upright ones
//!        |11      |9
//!        0----8---1
//! ```
//!
//! Integrated with 3 x 3 x 3 points (O. C. Zienkiewicz and R. L. Taylor, The Finite Element Method, Vol. 1, Sec. 8.7): exact
//! for brick-shaped elements, mass included.

use super::geometry::{NoVolume, THREE, points};
use super::hex8::CORNERS;
use super::material::Material;
use super::rules::integrate;
use crate::mesh::Shape;

/// Nodes on the reference cube: a coordinate of a mid-edge node is 0 along its edge.
const NODES: [[f64; 3]; 20] = {
    let edges = Shape::Hex20.edges();
    let mut nodes = [[0.0; 3]; 20];
    let mut i = 0;
    while i < 20 {
        let (from, to) = if i < 8 { (i, i) } else { edges[i - 8] };
        let mut a = 0;
        while a < 3 {
            nodes[i][a] = 0.5 * (CORNERS[from][a] + CORNERS[to][a]);
            a += 1;
        }
        i += 1;
    }
    nodes
};

/// N_i and ∂N_i/∂ξ_a at a point of the reference cube.
pub(super) fn functions(at: [f64; 3]) -> ([f64; 20], [[f64; 3]; 20]) {
    let (mut values, mut derivatives) = ([0.0; 20], [[0.0; 3]; 20]);
    for (i, node) in NODES.iter().enumerate() {
        // Each direction contributes the factor 1 + x_i x, or 1 - x² along the edge of a mid-edge node.
        let factor: [f64; 3] =
            std::array::from_fn(|a| if node[a] == 0.0 { 1.0 - at[a] * at[a] } else { 1.0 + node[a] * at[a] });
        let slope: [f64; 3] = std::array::from_fn(|a| if node[a] == 0.0 { -2.0 * at[a] } else { node[a] });
        let product = factor[0] * factor[1] * factor[2];
        let d = |a: usize| slope[a] * factor[(a + 1) % 3] * factor[(a + 2) % 3];
        if i < 8 {
            let extra = node[0] * at[0] + node[1] * at[1] + node[2] * at[2] - 2.0;
            values[i] = 0.125 * product * extra;
            derivatives[i] = std::array::from_fn(|a| 0.125 * (d(a) * extra + product * node[a]));
        } else {
            values[i] = 0.25 * product;
            derivatives[i] = std::array::from_fn(|a| 0.25 * d(a));
        }
    }
    (values, derivatives)
}

/// Stiffness (60 x 60) and mass (20 x 20).
pub(super) fn matrices(
    material: &Material,
    positions: &[[f64; 3]],
    out: (&mut [f64], &mut [f64]),
) -> Result<(), NoVolume> {
    integrate(points(&THREE), functions, material, positions, out)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// N_i is 1 at its own node and 0 at the others; derivatives agree with differences.
    #[test]
    fn shape_functions_interpolate() {
        for (i, node) in NODES.iter().enumerate() {
            let (values, _) = functions(*node);
            for (j, value) in values.iter().enumerate() {
                assert!((value - f64::from(u8::from(i == j))).abs() < 1e-15, "N_{j} at node {i}: {value}");
            }
        }
        let (at, h) = ([0.3, -0.2, 0.7], 1e-6);
        let (_, derivatives) = functions(at);
        for a in 0..3 {
            let (mut up, mut down) = (at, at);
            (up[a], down[a]) = (at[a] + h, at[a] - h);
            for (i, derivative) in derivatives.iter().enumerate() {
                let difference = (functions(up).0[i] - functions(down).0[i]) / (2.0 * h);
                assert!((difference - derivative[a]).abs() < 1e-9);
            }
        }
    }
}
