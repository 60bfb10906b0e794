//! Properties that every element must have: symmetry, rigid motions without force, patch test, mass, pure bending.
#![allow(clippy::unwrap_used, reason = "a failed test may panic")]

use iwan_fem::mesh::Shape;
use iwan_fem::{ElementMatrices, Error, Formulation, Inertia, Material};

type Point = [f64; 3];

const KINDS: [(Shape, Formulation); 7] = [
    (Shape::Hex8, Formulation::Displacement),
    (Shape::Hex8, Formulation::IncompatibleModes),
    (Shape::Hex20, Formulation::IncompatibleModes),
    (Shape::Tet4, Formulation::IncompatibleModes),
    (Shape::Tet10, Formulation::IncompatibleModes),
    (Shape::Wedge6, Formulation::IncompatibleModes),
    (Shape::Wedge15, Formulation::IncompatibleModes),
];

/// Corners of a piece of the brick, and the middles of its edges where the shape has nodes there.
fn with_middles(shape: Shape, brick: &[Point; 8]) -> Vec<Point> {
    let corners: &[usize] = match shape.corners() {
        4 => &[0, 1, 3, 4],
        6 => &[0, 1, 3, 4, 5, 7],
        _ => &[0, 1, 2, 3, 4, 5, 6, 7],
    };
    let corners: Vec<Point> = corners.iter().map(|corner| brick[*corner]).collect();
    let middle = |&(a, b): &(usize, usize)| std::array::from_fn(|i| 0.5 * (corners[a][i] + corners[b][i]));
    let edges = if shape.has_middles() { shape.edges() } else { &[] };
    corners.iter().copied().chain(edges.iter().map(middle)).collect()
}

/// Share of a brick's volume that an element of this shape takes.
fn share(shape: Shape) -> f64 {
    match shape.corners() {
        4 => 1.0 / 6.0,
        6 => 0.5,
        _ => 1.0,
    }
}

fn brick(size: Point) -> [Point; 8] {
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
        .map(|p| std::array::from_fn(|a| size[a] * f64::from(p[a])))
}

fn distorted() -> [Point; 8] {
    let shift = [[0.1, -0.05, 0.2], [0.0, 0.3, -0.1], [-0.2, 0.1, 0.15], [0.05, -0.1, 0.0]];
    let mut corners = brick([2.0, 1.5, 1.0]);
    for (i, corner) in corners.iter_mut().enumerate() {
        let s = shift[(3 * i + i / 4) % 4];
        *corner = std::array::from_fn(|a| corner[a] + s[a]);
    }
    corners
}

fn material() -> Material {
    Material::new(200.0, 0.3, 7.0).unwrap()
}

fn matrices(
    (shape, formulation): (Shape, Formulation),
    corners: &[Point; 8],
) -> (ElementMatrices, Vec<Point>) {
    let positions = with_middles(shape, corners);
    let options = (formulation, Inertia::Consistent);
    (ElementMatrices::of(1, shape, options, &material(), &positions).unwrap(), positions)
}

fn times(k: &[f64], u: &[f64]) -> Vec<f64> {
    k.chunks_exact(u.len()).map(|row| row.iter().zip(u).map(|(k, u)| k * u).sum()).collect()
}

fn norm(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// The field u = G x at each node.
fn linear_field(gradient: [[f64; 3]; 3], positions: &[Point]) -> Vec<f64> {
    let at = |x: &Point| gradient.map(|row| row[0] * x[0] + row[1] * x[1] + row[2] * x[2]);
    positions.iter().flat_map(at).collect()
}

#[test]
fn stiffness_is_symmetric_and_forgets_rigid_motion() {
    for kind in KINDS {
        let (element, positions) = matrices(kind, &distorted());
        let n = 3 * positions.len();
        let scale = element.stiffness.iter().fold(0.0_f64, |m, k| m.max(k.abs()));
        for i in 0..n {
            for j in 0..n {
                let difference = element.stiffness[i * n + j] - element.stiffness[j * n + i];
                assert!(difference.abs() < 1e-13 * scale, "{kind:?} {i} {j}");
            }
        }
        for axis in 0..3 {
            let translation: Vec<f64> = (0..n).map(|i| f64::from(u8::from(i % 3 == axis))).collect();
            let mut spin = [[0.0; 3]; 3];
            (spin[axis][(axis + 1) % 3], spin[(axis + 1) % 3][axis]) = (1.0, -1.0);
            for motion in [translation, linear_field(spin, &positions)] {
                assert!(
                    norm(&times(&element.stiffness, &motion)) < 1e-12 * scale * norm(&motion),
                    "{kind:?}"
                );
            }
        }
    }
}

/// Exactly six motions cost no energy: there are no spurious modes. The six-node wedge, integrated at two points on its axis, also twists
/// freely (two wedges side by side do not: the meshes of tests/convergence.rs have six such motions).
#[test]
fn there_are_six_zero_energy_motions() {
    for kind in KINDS {
        for corners in [brick([1.0, 2.0, 0.5]), distorted()] {
            let (element, positions) = matrices(kind, &corners);
            let n = 3 * positions.len();
            let k = faer::Mat::from_fn(n, n, |i, j| element.stiffness[i * n + j]);
            let values = k.self_adjoint_eigenvalues(faer::Side::Lower).unwrap();
            let zero = values.iter().filter(|v| v.abs() < 1e-10 * values[n - 1]).count();
            let expected = if kind.0 == Shape::Wedge6 { 7 } else { 6 };
            assert_eq!(zero, expected, "{kind:?} {values:?}");
            assert!(values[0] > -1e-10 * values[n - 1]);
        }
    }
}

/// A distorted element under a linear displacement field has constant stress: its nodal forces are those of the uniform traction, so that
/// they do the work V σ:ε on a second linear field.
#[test]
fn patch_test_of_a_distorted_element() {
    let (e1, e2) = (
        [[1e-3, 2e-4, -3e-4], [4e-4, -2e-3, 1e-4], [0.0, 5e-4, 7e-4]],
        [[2e-3, -1e-4, 6e-4], [0.0, 1e-3, 3e-4], [-5e-4, 2e-4, -1e-3]],
    );
    let strain = |g: [[f64; 3]; 3]| -> [[f64; 3]; 3] {
        std::array::from_fn(|a| std::array::from_fn(|b| 0.5 * (g[a][b] + g[b][a])))
    };
    let (m, first, second) = (material(), strain(e1), strain(e2));
    let trace = |e: [[f64; 3]; 3]| e[0][0] + e[1][1] + e[2][2];
    let mut expected = m.lame() * trace(first) * trace(second);
    for a in 0..3 {
        for b in 0..3 {
            expected += 2.0 * m.shear_modulus() * first[a][b] * second[a][b];
        }
    }
    for kind in KINDS {
        let (element, positions) = matrices(kind, &distorted());
        let volume = element.mass.iter().sum::<f64>() / m.density();
        let force = times(&element.stiffness, &linear_field(e1, &positions));
        let work: f64 = force.iter().zip(linear_field(e2, &positions)).map(|(f, u)| f * u).sum();
        assert!((work / (volume * expected) - 1.0).abs() < 1e-12, "{kind:?} {work}");
    }
}

#[test]
fn mass_is_that_of_the_volume_consistent_and_lumped() {
    for (shape, formulation) in KINDS {
        for inertia in [Inertia::Consistent, Inertia::Lumped] {
            let positions = with_middles(shape, &brick([2.0, 3.0, 0.5]));
            let element =
                ElementMatrices::of(1, shape, (formulation, inertia), &material(), &positions).unwrap();
            assert!((element.mass.iter().sum::<f64>() / (21.0 * share(shape)) - 1.0).abs() < 1e-13);
            let n = positions.len();
            assert!((0..n).all(|i| element.mass[i * n + i] > 0.0));
        }
    }
    // Consistent mass of a brick: the tensor product of [2 1; 1 2]/6.
    let (element, _) = matrices(KINDS[0], &brick([1.0, 1.0, 1.0]));
    assert!((element.mass[0] - 7.0 / 27.0).abs() < 1e-14 && (element.mass[6] - 7.0 / 216.0).abs() < 1e-14);
}

/// Pure bending of a slender brick at ν = 0: u_x = x z, u_z = -x²/2 stores E I l/2, which elements with incompatible modes reproduce
/// exactly.
#[test]
fn incompatible_modes_bend_exactly_and_plain_ones_lock() {
    let m = Material::new(200.0, 0.0, 1.0).unwrap();
    let (l, b, h) = (10.0, 1.0, 1.0);
    let corners = brick([l, b, h]).map(|p| [p[0] - 0.5 * l, p[1], p[2] - 0.5 * h]);
    let exact = 0.5 * 200.0 * b * h.powi(3) / 12.0 * l;
    for (shape, formulation) in &KINDS[..3] {
        let (shape, formulation) = (*shape, *formulation);
        let positions = with_middles(shape, &corners);
        let element =
            ElementMatrices::of(1, shape, (formulation, Inertia::Consistent), &m, &positions).unwrap();
        let u: Vec<f64> = positions.iter().flat_map(|p| [p[0] * p[2], 0.0, -0.5 * p[0] * p[0]]).collect();
        let energy: f64 = 0.5 * times(&element.stiffness, &u).iter().zip(&u).map(|(f, u)| f * u).sum::<f64>();
        if formulation == Formulation::Displacement {
            assert!(energy > 50.0 * exact, "shear locking of a 10:1 element: {energy} against {exact}");
        } else {
            assert!((energy / exact - 1.0).abs() < 1e-11, "{shape:?} {energy} {exact}");
        }
    }
}

#[test]
fn inverted_flat_and_collapsed_elements_are_named() {
    let inverted = brick([1.0, 1.0, -1.0]);
    let flat = brick([1.0, 1.0, 0.0]);
    let not_a_number = brick([1.0, f64::NAN, 1.0]);
    for corners in [inverted, flat, not_a_number] {
        for (shape, formulation) in KINDS {
            let positions = with_middles(shape, &corners);
            let options = (formulation, Inertia::Consistent);
            let error = ElementMatrices::of(77, shape, options, &material(), &positions).unwrap_err();
            assert!(matches!(error, Error::Element { label: 77, .. }), "{error}");
            assert!(error.to_string().contains("element 77"), "{error}");
        }
    }
}

#[test]
fn impossible_materials_are_named() {
    for (e, nu, rho, name) in
        [(0.0, 0.3, 1.0, "young"), (1.0, 0.5, 1.0, "poisson"), (1.0, 0.3, f64::NAN, "density")]
    {
        let error = Material::new(e, nu, rho).unwrap_err().to_string();
        assert!(error.starts_with(name), "{error}");
    }
}
