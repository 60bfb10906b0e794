//! Quality of an element: its scaled Jacobian determinant. It is 1 for a brick, a regular tetrahedron and a wedge on a regular triangle, 0
//! for a collapsed element, and negative for an inverted one.
//!
//! P. M. Knupp, Int. J. Numer. Meth. Eng. 48:1165, 2000 (the determinant of the edges at a corner over the product of their lengths,
//! scaled by that of the ideal element).

use super::geometry::{THREE, TWO, points};
use super::rules::{TETRAHEDRON_1, TETRAHEDRON_4, WEDGE_2, WEDGE_9};
use super::{hex8, hex20, tet4, tet10, wedge6, wedge15};
use crate::mesh::Shape;

/// Neighbours of each corner along its three edges, right-handed.
fn neighbours(shape: Shape) -> &'static [[usize; 3]] {
    match shape {
        Shape::Hex8 | Shape::Hex20 => {
            &[[1, 3, 4], [2, 0, 5], [3, 1, 6], [0, 2, 7], [7, 5, 0], [4, 6, 1], [5, 7, 2], [6, 4, 3]]
        }
        Shape::Tet4 | Shape::Tet10 => &[[1, 2, 3], [2, 0, 3], [0, 1, 3], [0, 2, 1]],
        Shape::Wedge6 | Shape::Wedge15 => &[[1, 2, 3], [2, 0, 4], [0, 1, 5], [5, 4, 0], [3, 5, 1], [4, 3, 2]],
    }
}

/// Corners of the reference element.
fn corners(shape: Shape) -> &'static [[f64; 3]] {
    match shape {
        Shape::Hex8 | Shape::Hex20 => &hex8::CORNERS,
        Shape::Tet4 | Shape::Tet10 => &tet4::CORNERS,
        Shape::Wedge6 | Shape::Wedge15 => &wedge6::CORNERS,
    }
}

/// Scale factor of the shape: one over the determinant of the unit edges at a corner of the ideal element, √2 for the regular tetrahedron
/// and 2/√3 for the wedge.
fn ideal(shape: Shape) -> f64 {
    match shape {
        Shape::Hex8 | Shape::Hex20 => 1.0,
        Shape::Tet4 | Shape::Tet10 => std::f64::consts::SQRT_2,
        Shape::Wedge6 | Shape::Wedge15 => 2.0 / 3.0_f64.sqrt(),
    }
}

/// Scaled determinants at the corners. `positions` are those of the nodes, in the order of [`Shape`].
pub(crate) fn corner_quality(shape: Shape, positions: &[[f64; 3]]) -> Vec<f64> {
    let places = corners(shape);
    let at_corner = |(corner, near): (&[f64; 3], &[usize; 3])| {
        scaled(shape, positions, *corner, near.map(|n| std::array::from_fn(|a| places[n][a] - corner[a])))
    };
    places.iter().zip(neighbours(shape)).map(at_corner).collect()
}

/// The smallest scaled determinant at the integration points.
pub(crate) fn least_quality_inside(shape: Shape, positions: &[[f64; 3]]) -> f64 {
    const AXES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let at = |rule: &[([f64; 3], f64)]| {
        rule.iter().map(|point| scaled(shape, positions, point.0, AXES)).fold(f64::INFINITY, f64::min)
    };
    match shape {
        Shape::Hex8 => at(&points(&TWO).collect::<Vec<_>>()),
        Shape::Hex20 => at(&points(&THREE).collect::<Vec<_>>()),
        Shape::Tet4 => at(&TETRAHEDRON_1),
        Shape::Tet10 => at(&TETRAHEDRON_4),
        Shape::Wedge6 => at(&WEDGE_2),
        Shape::Wedge15 => at(&WEDGE_9),
    }
}

/// Determinant of the tangents ∂x/∂ξ along three directions over the product of their lengths, divided by that of the ideal element, at
/// most 1; 0 if a tangent has no length.
fn scaled(shape: Shape, positions: &[[f64; 3]], at: [f64; 3], directions: [[f64; 3]; 3]) -> f64 {
    let [x, y, z] = match shape {
        Shape::Hex8 => tangents(&hex8::derivatives(at), positions),
        Shape::Hex20 => tangents(&hex20::functions(at).1, positions),
        Shape::Tet4 => tangents(&tet4::functions(at).1, positions),
        Shape::Tet10 => tangents(&tet10::functions(at).1, positions),
        Shape::Wedge6 => tangents(&wedge6::functions(at).1, positions),
        Shape::Wedge15 => tangents(&wedge15::functions(at).1, positions),
    };
    let [a, b, c] = directions.map(|d| {
        let t: [f64; 3] = std::array::from_fn(|i| d[0] * x[i] + d[1] * y[i] + d[2] * z[i]);
        let length = t.iter().map(|x| x * x).sum::<f64>().sqrt();
        if length > 0.0 { t.map(|x| x / length) } else { [0.0; 3] }
    });
    let determinant = a[0] * (b[1] * c[2] - b[2] * c[1])
        + a[1] * (b[2] * c[0] - b[0] * c[2])
        + a[2] * (b[0] * c[1] - b[1] * c[0]);
    (ideal(shape) * determinant).min(1.0)
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

    /// The reference element, stretched, with mid-edge nodes in the middle of straight edges.
    fn stretched(shape: Shape, sides: [f64; 3]) -> Vec<[f64; 3]> {
        let corner = |i: usize| -> [f64; 3] { std::array::from_fn(|a| corners(shape)[i][a] * sides[a]) };
        let middle = |&(i, j): &(usize, usize)| std::array::from_fn(|a| 0.5 * (corner(i)[a] + corner(j)[a]));
        (0..shape.corners()).map(corner).chain(shape.edges().iter().map(middle)).collect()
    }

    #[test]
    fn every_brick_has_quality_one_and_its_mirror_image_minus_one() {
        for (shape, count) in [(Shape::Hex8, 8), (Shape::Hex20, 20)] {
            for (sides, expected) in [([3.0, 2.0, 0.01], 1.0), ([1.0, 1.0, -1.0], -1.0)] {
                let nodes = &stretched(shape, sides)[..count];
                assert!(corner_quality(shape, nodes).iter().all(|q| (q - expected).abs() < 1e-13));
                assert!((least_quality_inside(shape, nodes) - expected).abs() < 1e-13);
            }
        }
    }

    /// Regular tetrahedra and wedges have quality 1 at every corner, mirrored ones -1, and flat ones 0.
    #[test]
    fn tetrahedra_and_wedges_are_measured_against_regular_ones() {
        for shape in [Shape::Tet4, Shape::Tet10, Shape::Wedge6, Shape::Wedge15] {
            let tet = shape.corners() == 4;
            let (x, y) = (0.5, 0.75_f64.sqrt());
            let regular = |p: [f64; 3]| {
                let z = if tet { p[2] * (2.0_f64 / 3.0).sqrt() } else { p[2] };
                let lean = if tet { p[2] } else { 0.0 };
                [p[0] + x * p[1] + 0.5 * lean, y * p[1] + y / 3.0 * lean, z]
            };
            let nodes: Vec<_> =
                stretched(shape, [1.0; 3])[..shape.nodes()].iter().map(|p| regular(*p)).collect();
            let quality = corner_quality(shape, &nodes);
            assert_eq!(quality.len(), shape.corners());
            assert!(quality.iter().all(|q| (q - 1.0).abs() < 1e-13), "{shape:?} {quality:?}");
            let mirrored: Vec<_> = nodes.iter().map(|p| [p[0], p[1], -p[2]]).collect();
            assert!(corner_quality(shape, &mirrored).iter().all(|q| (q + 1.0).abs() < 1e-13));
            assert!(
                least_quality_inside(shape, &nodes) > 0.9 && least_quality_inside(shape, &mirrored) < -0.9
            );
            let flat: Vec<_> = nodes.iter().map(|p| [p[0], p[1], 0.0]).collect();
            assert!(corner_quality(shape, &flat).iter().all(|q| q.abs() < 1e-13));
        }
    }

    #[test]
    fn a_mid_edge_node_at_the_quarter_point_is_seen_at_the_corner_only() {
        let mut nodes = stretched(Shape::Hex20, [1.0; 3]);
        nodes[8][0] = -0.5; // ∂x/∂ξ = 0 at corner 0
        let corners = corner_quality(Shape::Hex20, &nodes);
        assert!(corners[0].abs() < 1e-14 && corners[1] > 0.9, "{corners:?}");
        assert!(least_quality_inside(Shape::Hex20, &nodes) > 0.1);
    }
}
