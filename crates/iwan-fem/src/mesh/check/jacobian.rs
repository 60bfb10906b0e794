//! Jacobian determinants of hexahedra at any point of the reference cube.

use super::super::Shape;

/// Reference coordinates of the corners.
const CORNERS: [[f64; 3]; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];

/// Reference coordinates of the mid-edge nodes 8 to 19.
const MIDDLES: [[f64; 3]; 12] = [
    [0.0, -1.0, -1.0],
    [1.0, 0.0, -1.0],
    [0.0, 1.0, -1.0],
    [-1.0, 0.0, -1.0],
    [0.0, -1.0, 1.0],
    [1.0, 0.0, 1.0],
    [0.0, 1.0, 1.0],
    [-1.0, 0.0, 1.0],
    [-1.0, -1.0, 0.0],
    [1.0, -1.0, 0.0],
    [1.0, 1.0, 0.0],
    [-1.0, 1.0, 0.0],
];

/// The three tangents dx/dξ, dx/dη, dx/dζ at the reference point `at`.
fn tangents(shape: Shape, nodes: &[[f64; 3]], at: [f64; 3]) -> [[f64; 3]; 3] {
    let mut sums = [[0.0; 3]; 3];
    for (number, position) in nodes.iter().enumerate() {
        let slopes = slopes(shape, number, at);
        for (sum, slope) in sums.iter_mut().zip(slopes) {
            for (component, x) in sum.iter_mut().zip(position) {
                *component += slope * x;
            }
        }
    }
    sums
}

/// Derivatives of the shape function of one node; trilinear, or of the serendipity family of second degree
/// (Zienkiewicz and Taylor, The Finite Element Method, vol. 1, chapter on shape functions).
fn slopes(shape: Shape, number: usize, at: [f64; 3]) -> [f64; 3] {
    let (corner, middle) = (number < 8, MIDDLES.get(number.wrapping_sub(8)));
    let home = if corner { CORNERS[number] } else { *middle.unwrap_or(&[0.0; 3]) };
    // Factor along each axis and its derivative: (1 + ξ ξ_i)/2, or 1 - ξ² along the edge of a mid-edge node.
    let factor = |axis: usize| {
        let (x, h) = (at[axis], home[axis]);
        if h == 0.0 { (1.0 - x * x, -2.0 * x) } else { (0.5 * (1.0 + x * h), 0.5 * h) }
    };
    let factors = [factor(0), factor(1), factor(2)];
    let product = |axis: usize| factors[axis].1 * factors[(axis + 1) % 3].0 * factors[(axis + 2) % 3].0;
    let plain = [product(0), product(1), product(2)];
    if shape == Shape::Hex8 || !corner {
        return plain;
    }
    // N = N_linear (ξ ξ_i + η η_i + ζ ζ_i - 2)
    let linear = factors[0].0 * factors[1].0 * factors[2].0;
    let bracket = (0..3).map(|axis| at[axis] * home[axis]).sum::<f64>() - 2.0;
    std::array::from_fn(|axis| plain[axis] * bracket + linear * home[axis])
}

/// Determinant of the Jacobian over the product of the lengths of its three tangents: 1 for a brick, 0 where the
/// element is collapsed, negative where it is inverted. A tangent of no length gives 0.
fn scaled(shape: Shape, nodes: &[[f64; 3]], at: [f64; 3]) -> f64 {
    let [a, b, c] = tangents(shape, nodes, at).map(|t| {
        let length = t.iter().map(|x| x * x).sum::<f64>().sqrt();
        if length > 0.0 { t.map(|x| x / length) } else { [0.0; 3] }
    });
    a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
        + a[2] * (b[0] * c[1] - b[1] * c[0])
}

/// Scaled determinants at the eight corners.
pub(super) fn at_corners(shape: Shape, nodes: &[[f64; 3]]) -> [f64; 8] {
    CORNERS.map(|corner| scaled(shape, nodes, corner))
}

/// The smallest scaled determinant at the Gauss points: 2 x 2 x 2 for 8 nodes, 3 x 3 x 3 for 20.
pub(super) fn least_inside(shape: Shape, nodes: &[[f64; 3]]) -> f64 {
    let (two, three) =
        ([-1.0, 1.0].map(|x| x / 3.0_f64.sqrt()), [-1.0, 0.0, 1.0].map(|x| x * 0.6_f64.sqrt()));
    let abscissas = if shape == Shape::Hex8 { &two[..] } else { &three[..] };
    let mut least = f64::INFINITY;
    for x in abscissas {
        for y in abscissas {
            for z in abscissas {
                least = least.min(scaled(shape, nodes, [*x, *y, *z]));
            }
        }
    }
    least
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mapping_of_a_brick_is_constant() {
        let brick = |node: [f64; 3]| [3.0 * node[0], 2.0 * node[1], 0.1 * node[2]];
        let nodes: Vec<_> = CORNERS.into_iter().chain(MIDDLES).map(brick).collect();
        for (shape, nodes) in [(Shape::Hex8, &nodes[..8]), (Shape::Hex20, &nodes[..])] {
            for at in [[0.3, -0.7, 0.2], [1.0, 1.0, -1.0], [0.0; 3]] {
                let [a, b, c] = tangents(shape, nodes, at);
                for (tangent, expected) in [(a, [3.0, 0.0, 0.0]), (b, [0.0, 2.0, 0.0]), (c, [0.0, 0.0, 0.1])]
                {
                    assert!(tangent.iter().zip(expected).all(|(x, y)| (x - y).abs() < 1e-14), "{tangent:?}");
                }
            }
            assert!(at_corners(shape, nodes).iter().all(|j| (j - 1.0).abs() < 1e-14));
        }
    }

    #[test]
    fn a_mid_edge_node_at_the_quarter_point_is_seen_at_the_corner() {
        let mut nodes: Vec<_> = CORNERS.into_iter().chain(MIDDLES).collect();
        nodes[8][0] = -0.5; // dx/dξ = 0 at corner 0
        let corners = at_corners(Shape::Hex20, &nodes);
        assert!(corners[0].abs() < 1e-14 && corners[1] > 0.9, "{corners:?}");
        assert!(least_inside(Shape::Hex20, &nodes) > 0.0);
    }
}
