//! Quality of an element: its scaled Jacobian determinant, 1 for a brick, 0 where it is collapsed, negative where it is
//! inverted.

use super::geometry::{THREE, TWO, points};
use super::{hex8, hex20};
use crate::mesh::Shape;

/// Scaled determinants at the eight corners. `positions` are those of the nodes, in the order of [`Shape`].
pub(crate) fn corner_quality(shape: Shape, positions: &[[f64; 3]]) -> [f64; 8] {
    hex8::CORNERS.map(|corner| scaled(shape, positions, corner))
}

/// The smallest scaled determinant at the integration points.
pub(crate) fn least_quality_inside(shape: Shape, positions: &[[f64; 3]]) -> f64 {
    let rule = match shape {
        Shape::Hex8 => &TWO[..],
        Shape::Hex20 => &THREE[..],
    };
    points(rule).map(|(at, _)| scaled(shape, positions, at)).fold(f64::INFINITY, f64::min)
}

/// Determinant of the Jacobian over the product of the lengths of its tangents ∂x/∂ξ_a; 0 where a tangent has no length.
fn scaled(shape: Shape, positions: &[[f64; 3]], at: [f64; 3]) -> f64 {
    let [a, b, c] = match shape {
        Shape::Hex8 => tangents(&hex8::derivatives(at), positions),
        Shape::Hex20 => tangents(&hex20::functions(at).1, positions),
    }
    .map(|t| {
        let length = t.iter().map(|x| x * x).sum::<f64>().sqrt();
        if length > 0.0 { t.map(|x| x / length) } else { [0.0; 3] }
    });
    a[0] * (b[1] * c[2] - b[2] * c[1])
        + a[1] * (b[2] * c[0] - b[0] * c[2])
        + a[2] * (b[0] * c[1] - b[1] * c[0])
}

fn tangents(derivatives: &[[f64; 3]], positions: &[[f64; 3]]) -> [[f64; 3]; 3] {
    let mut tangents = [[0.0; 3]; 3];
    for (slopes, position) in derivatives.iter().zip(positions) {
        for (tangent, slope) in tangents.iter_mut().zip(slopes) {
            for (component, x) in tangent.iter_mut().zip(position) {
                *component += slope * x;
            }
        }
    }
    tangents
}

#[cfg(test)]
mod tests {
    use super::*;

    fn brick(sides: [f64; 3]) -> Vec<[f64; 3]> {
        let corner = |i: usize| -> [f64; 3] { std::array::from_fn(|a| hex8::CORNERS[i][a] * sides[a]) };
        let middle = |&(i, j): &(usize, usize)| std::array::from_fn(|a| 0.5 * (corner(i)[a] + corner(j)[a]));
        (0..8).map(corner).chain(Shape::Hex20.edges().iter().map(middle)).collect()
    }

    #[test]
    fn every_brick_has_quality_one_and_its_mirror_image_minus_one() {
        for (shape, count) in [(Shape::Hex8, 8), (Shape::Hex20, 20)] {
            for (sides, expected) in [([3.0, 2.0, 0.01], 1.0), ([1.0, 1.0, -1.0], -1.0)] {
                let nodes = &brick(sides)[..count];
                assert!(corner_quality(shape, nodes).iter().all(|q| (q - expected).abs() < 1e-13));
                assert!((least_quality_inside(shape, nodes) - expected).abs() < 1e-13);
            }
        }
    }

    #[test]
    fn a_mid_edge_node_at_the_quarter_point_is_seen_at_the_corner_only() {
        let mut nodes = brick([1.0; 3]);
        nodes[8][0] = -0.5; // ∂x/∂ξ = 0 at corner 0
        let corners = corner_quality(Shape::Hex20, &nodes);
        assert!(corners[0].abs() < 1e-14 && corners[1] > 0.9, "{corners:?}");
        assert!(least_quality_inside(Shape::Hex20, &nodes) > 0.1);
    }
}
