//! Integration rules for tetrahedra and wedges, and stiffness and mass of an element integrated by such a rule.
//!
//! Number and places of the points are those of CalculiX (G. Dhondt, CalculiX User's Manual, Sec. "Element types"): one and four points in
//! tetrahedra, two and nine in wedges, for stiffness and mass alike. The stiffness of elements with straight edges is exact, except for the
//! six-node wedge. The mass is integrated with the same points: its total is exact, and so is its rate of convergence (P. G. Ciarlet, The
//! Finite Element Method for Elliptic Problems, Sec. 4.1, requires degree 2p - 2 for elements of degree p).

use super::geometry::{Jacobian, NoVolume};
use super::isotropic::{GradientProducts, add_mass};
use super::material::Material;

/// A point of the reference element, with its weight.
pub(super) type Point = ([f64; 3], f64);

/// Degree 1: the centre of the reference tetrahedron, whose volume is 1/6.
pub(super) const TETRAHEDRON_1: [Point; 1] = [([0.25; 3], 1.0 / 6.0)];

/// Degree 2: four points at a = (5 - √5)/20 from three faces and b = 1 - 3a from the fourth (P. C. Hammer, O. J. Marlowe and
/// A. H. Stroud, Math. Tables Aids Comput. 10:130, 1956).
pub(super) const TETRAHEDRON_4: [Point; 4] =
    [([A, A, A], 1.0 / 24.0), ([B, A, A], 1.0 / 24.0), ([A, B, A], 1.0 / 24.0), ([A, A, B], 1.0 / 24.0)];
const A: f64 = 0.138_196_601_125_010_5;
const B: f64 = 0.585_410_196_624_968_5;

/// Two points on the axis of the wedge: the centre of the triangle, times two Gauss points along the height.
pub(super) const WEDGE_2: [Point; 2] = [([THIRD, THIRD, -GAUSS_2], 0.5), ([THIRD, THIRD, GAUSS_2], 0.5)];
const THIRD: f64 = 1.0 / 3.0;
const GAUSS_2: f64 = 0.577_350_269_189_625_8;

/// Nine points: three points of degree 2 in the triangle, times three Gauss points along the height.
pub(super) const WEDGE_9: [Point; 9] = {
    let triangle = [[1.0 / 6.0, 1.0 / 6.0], [2.0 / 3.0, 1.0 / 6.0], [1.0 / 6.0, 2.0 / 3.0]];
    let line = super::geometry::THREE;
    let mut points = [([0.0; 3], 0.0); 9];
    let mut i = 0;
    while i < 9 {
        let ([x, y], (z, weight)) = (triangle[i % 3], line[i / 3]);
        points[i] = ([x, y, z], weight / 6.0);
        i += 1;
    }
    points
};

/// N_i and ∂N_i/∂ξ_a at a point of the reference element.
pub(super) type Functions<const N: usize> = fn([f64; 3]) -> ([f64; N], [[f64; 3]; N]);

/// Stiffness (3N x 3N) and mass (N x N) of an element with the given shape functions.
pub(super) fn integrate<const N: usize>(
    rule: impl IntoIterator<Item = Point>,
    functions: Functions<N>,
    material: &Material,
    positions: &[[f64; 3]],
    (stiffness, mass): (&mut [f64], &mut [f64]),
) -> Result<(), NoVolume> {
    let mut products = GradientProducts::<N>::new();
    for (point, (at, weight)) in rule.into_iter().enumerate() {
        let (values, d) = functions(at);
        let jacobian = Jacobian::new(&d, positions, point + 1)?;
        products.add(&d.map(|d| jacobian.gradient(d)), weight * jacobian.determinant);
        add_mass(&values, material.density() * weight * jacobian.determinant, mass);
    }
    products.stiffness(material, stiffness);
    Ok(())
}

/// Properties that every set of shape functions must have, for the tests of the elements: N_i is 1 at its own node and 0 at the others, the
/// sum is 1 everywhere, and derivatives agree with difference quotients.
#[cfg(test)]
pub(super) fn assert_interpolation<const N: usize>(functions: Functions<N>, nodes: &[[f64; 3]; N]) {
    for (i, node) in nodes.iter().enumerate() {
        for (j, value) in functions(*node).0.iter().enumerate() {
            assert!((value - f64::from(u8::from(i == j))).abs() < 1e-15, "N_{j} at node {i}: {value}");
        }
    }
    let (at, h) = ([0.3, 0.2, 0.4], 1e-6);
    let (values, derivatives) = functions(at);
    assert!((values.iter().sum::<f64>() - 1.0).abs() < 1e-15);
    for a in 0..3 {
        let (mut up, mut down) = (at, at);
        (up[a], down[a]) = (at[a] + h, at[a] - h);
        for (i, derivative) in derivatives.iter().enumerate() {
            let difference = (functions(up).0[i] - functions(down).0[i]) / (2.0 * h);
            assert!((difference - derivative[a]).abs() < 1e-9, "∂N_{i}/∂ξ_{a}");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn integral(rule: &[Point], [i, j, k]: [i32; 3]) -> f64 {
        rule.iter().map(|([x, y, z], w)| w * x.powi(i) * y.powi(j) * z.powi(k)).sum()
    }

    fn factorial(n: i32) -> f64 {
        (1..=n).map(f64::from).product()
    }

    /// ∫ x^i y^j z^k = i! j! k!/(i+j+k+3)! over the reference tetrahedron; over the wedge i! j!/(i+j+2)! times 2/(k+1) for even k.
    #[test]
    fn rules_are_exact_to_their_degree() {
        let tetrahedron =
            |[i, j, k]: [i32; 3]| factorial(i) * factorial(j) * factorial(k) / factorial(i + j + k + 3);
        let wedge = |[i, j, k]: [i32; 3]| {
            factorial(i) * factorial(j) / factorial(i + j + 2)
                * if k % 2 == 0 { 2.0 / f64::from(k + 1) } else { 0.0 }
        };
        for (i, j, k) in
            [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (2, 0, 0), (1, 1, 0), (0, 1, 1), (0, 0, 2)]
        {
            let powers = [i, j, k];
            if i + j + k <= 1 {
                assert!((integral(&TETRAHEDRON_1, powers) - tetrahedron(powers)).abs() < 1e-16);
            }
            assert!((integral(&TETRAHEDRON_4, powers) - tetrahedron(powers)).abs() < 1e-16, "{powers:?}");
            if i + j <= 1 {
                assert!((integral(&WEDGE_2, powers) - wedge(powers)).abs() < 1e-15, "{powers:?}");
            }
            assert!((integral(&WEDGE_9, powers) - wedge(powers)).abs() < 1e-15, "{powers:?}");
        }
        assert!((integral(&WEDGE_9, [1, 1, 4]) - wedge([1, 1, 4])).abs() < 1e-15);
    }
}
