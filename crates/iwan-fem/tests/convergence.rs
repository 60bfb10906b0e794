//! Rates of convergence of all solid elements against a closed form, patch tests of mixed meshes, and bending.
#![allow(clippy::unwrap_used, reason = "a failed test may panic")]

use std::f64::consts::PI;

use crate::solids::{cut, some_cut, with_middles};
use iwan_fem::mesh::block::{block, uniform};
use iwan_fem::mesh::{Mesh, Shape};
use iwan_fem::{Formulation, Limit, Material, Structure, Support};

/// A quarter of a block with sides 1, the corner x, y < 1/2, and of this the lower half: n x n x n/2 bricks, cut into elements of the given
/// shape.
fn body(shape: Shape, n: usize) -> Mesh {
    let mut mesh = block(&[uniform(0.0, 0.5, n), uniform(0.0, 0.5, n), uniform(0.0, 0.25, n / 2)]);
    cut(&mut mesh, shape);
    with_middles(&mut mesh, shape);
    mesh
}

/// Lamé's mode of a free block with sides L: u = (cos kx sin ky, -sin kx cos ky, 0), k = π/L, strains without changing the volume and
/// leaves all planes x, y = 0, L and z = constant free of stress; ω = √2 k √(μ/ρ) (G. Lamé, Leçons sur la théorie mathématique de
/// l'élasticité des corps solides, 1852). Planes of symmetry are x = L/2, y = L/2 and any z.
fn lame(positions: &[[f64; 3]]) -> Vec<f64> {
    let at = |p: &[f64; 3]| {
        let (x, y) = (PI * p[0], PI * p[1]);
        [x.cos() * y.sin(), -x.sin() * y.cos(), 0.0]
    };
    positions.iter().flat_map(at).collect()
}

/// Relative error of ω² of the computed mode that is Lamé's.
fn error(shape: Shape, formulation: Formulation, n: usize) -> f64 {
    let material = Material::new(2.6, 0.3, 1.0).unwrap();
    let exact = 2.0 * PI * PI * material.shear_modulus();
    let mut mesh = body(shape, n);
    let field = lame(&mesh.positions);
    for (axis, (name, plane)) in [("x", 0.5), ("y", 0.5), ("z", 0.0)].into_iter().enumerate() {
        let on = |node: &usize| mesh.positions[*node][axis] == plane;
        let nodes = (0..mesh.positions.len()).filter(on).collect();
        mesh.node_sets.insert(name.into(), nodes);
    }
    let mut structure = Structure::new(mesh, material);
    structure.formulation = formulation;
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        let fixed = std::array::from_fn(|a| a == axis);
        structure.supports.push(Support { name: name.into(), nodes: name.into(), fixed });
    }
    assert_eq!(structure.check().message(), None);
    let assembled = structure.assemble().unwrap();
    let modes = assembled.modes(Limit::Stuck, 4).unwrap();
    let likeness = |mode: &usize| {
        let shape = assembled.displacements(modes.shape(*mode));
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        dot(&shape, &field).powi(2) / (dot(&shape, &shape) * dot(&field, &field))
    };
    let best = (0..4).max_by(|a, b| likeness(a).total_cmp(&likeness(b))).unwrap();
    assert!(likeness(&best) > 0.95, "{shape:?} {n}: {}", likeness(&best));
    (2.0 * PI * modes.frequencies()[best]).powi(2) / exact - 1.0
}

/// Eigenvalues from elements of degree p have an error of order h^2p (G. Strang and G. J. Fix, An Analysis of the Finite Element Method,
/// 1973, Sec. 6.3), here on meshes cut from bricks. Meshes of cut elements approach this rate from below: on meshes twice as fine, four-
/// and six-node elements have rates of 1.85 and 1.87.
#[test]
fn eigenvalues_converge_with_twice_the_degree() {
    let plain = Formulation::Displacement;
    let linear = [
        (Shape::Hex8, plain),
        (Shape::Hex8, Formulation::IncompatibleModes),
        (Shape::Tet4, plain),
        (Shape::Wedge6, plain),
    ];
    for (shape, formulation) in linear {
        let (coarse, fine) = (error(shape, formulation, 8), error(shape, formulation, 16));
        let rate = (coarse / fine).log2();
        assert!(
            (rate - 2.0).abs() < 0.35,
            "{shape:?} {formulation:?}: {coarse:.3e} {fine:.3e}, rate {rate:.2}"
        );
    }
    for shape in [Shape::Hex20, Shape::Tet10, Shape::Wedge15] {
        let (coarse, fine) = (error(shape, plain, 4), error(shape, plain, 8));
        let rate = (coarse / fine).log2();
        assert!((rate - 4.0).abs() < 0.35, "{shape:?}: {coarse:.3e} {fine:.3e}, rate {rate:.2}");
    }
}

/// A function that changes a mesh of bricks into another mesh.
type Prepare = fn(&mut Mesh);

/// On a distorted mesh a linear field leaves no force on any inner node, whatever the elements: bricks and wedges mixed, tetrahedra.
#[test]
fn patch_test_of_meshes() {
    let inside = |p: &[f64; 3]| p.iter().all(|x| *x > 0.01 && *x < 2.99);
    let bump = |p: [f64; 3]| {
        if inside(&p) {
            p.map(|x| x + 0.2 * (7.0 * (p[0] + 2.0 * p[1] + 3.0 * p[2])).sin() * (x + 0.3))
        } else {
            p
        }
    };
    let cases: [(&str, Prepare); 5] = [
        ("bricks and wedges", |mesh| some_cut(mesh, Shape::Wedge6, |e| e % 3 == 0)),
        ("bricks and wedges of 20 and 15 nodes", |mesh| {
            some_cut(mesh, Shape::Wedge6, |e| e % 2 == 0);
            with_middles(mesh, Shape::Hex20);
        }),
        ("tetrahedra", |mesh| cut(mesh, Shape::Tet4)),
        ("tetrahedra of 10 nodes", |mesh| {
            cut(mesh, Shape::Tet4);
            with_middles(mesh, Shape::Tet10);
        }),
        ("wedges", |mesh| cut(mesh, Shape::Wedge6)),
    ];
    for (name, prepare) in cases {
        let mut mesh = block(&[uniform(0.0, 3.0, 3), uniform(0.0, 3.0, 3), uniform(0.0, 3.0, 3)]);
        mesh.positions.iter_mut().for_each(|p| *p = bump(*p));
        prepare(&mut mesh);
        let positions = mesh.positions.clone();
        let assembled = Structure::new(mesh, Material::new(200.0, 0.3, 7.0).unwrap()).assemble().unwrap();
        let u: Vec<f64> = positions
            .iter()
            .flat_map(|[x, y, z]| [1e-3 * x + 2e-4 * y, 4e-4 * x - 2e-3 * z, 5e-4 * y + 7e-4 * z])
            .collect();
        let force = assembled.slipping_stiffness().times(&u);
        let largest = force.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
        let mut checked = 0;
        for (node, _) in positions.iter().enumerate().filter(|(_, p)| inside(p)) {
            checked += 1;
            let left = (0..3).fold(0.0_f64, |m, a| m.max(force[3 * node + a].abs()));
            assert!(left < 1e-13 * largest, "{name} node {node}: {left:e} beside {largest:e}");
        }
        assert!(checked >= 8, "{name}");
        let volume = assembled.total_mass() / 7.0;
        assert!((volume - 27.0).abs() < 1e-12, "{name}: {volume}");
    }
}

/// Ten- and fifteen-node elements represent a quadratic displacement exactly: pure bending of a slender block at ν = 0 stores E I l/2.
/// Four- and six-node elements lock.
#[test]
fn quadratic_elements_bend_exactly_and_linear_ones_lock() {
    let exact = 0.5 * 200.0 * (0.5_f64.powi(3) / 12.0) * 10.0;
    for (shape, locks) in [
        (Shape::Tet10, false),
        (Shape::Wedge15, false),
        (Shape::Hex20, false),
        (Shape::Tet4, true),
        (Shape::Wedge6, true),
    ] {
        let mut mesh = block(&[uniform(-5.0, 5.0, 4), uniform(0.0, 1.0, 1), uniform(-0.25, 0.25, 1)]);
        cut(&mut mesh, shape);
        with_middles(&mut mesh, shape);
        let u: Vec<f64> =
            mesh.positions.iter().flat_map(|p| [p[0] * p[2], 0.0, -0.5 * p[0] * p[0]]).collect();
        let assembled = Structure::new(mesh, Material::new(200.0, 0.0, 1.0).unwrap()).assemble().unwrap();
        let energy = 0.5 * assembled.slipping_stiffness().form(&u, &u);
        let ratio = energy / exact;
        assert_eq!(ratio > 2.0, locks, "{shape:?} {ratio}");
        assert!(locks || (ratio - 1.0).abs() < 1e-11, "{shape:?} {ratio}");
    }
}

#[test]
fn linear_tetrahedra_earn_a_remark() {
    let remarks = |shape| {
        let structure = Structure::new(body(shape, 2), Material::new(1.0, 0.3, 1.0).unwrap());
        structure.check().remarks.iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    assert!(
        remarks(Shape::Tet4)[0]
            .starts_with("24 elements are tetrahedra of 4 nodes (the first is 1): much too stiff")
    );
    assert!(remarks(Shape::Tet10).is_empty() && remarks(Shape::Wedge6).is_empty());
}

/// The outer faces of a cut block are those of the block only, with none inside, and they enclose its volume.
#[test]
fn outer_faces_of_mixed_meshes_enclose_the_volume() {
    let mut mixed = block(&[uniform(0.0, 3.0, 3), uniform(0.0, 2.0, 2), uniform(0.0, 1.0, 2)]);
    some_cut(&mut mixed, Shape::Wedge6, |e| e % 2 == 0);
    let mut tetrahedra = block(&[uniform(0.0, 3.0, 3), uniform(0.0, 2.0, 2), uniform(0.0, 1.0, 2)]);
    cut(&mut tetrahedra, Shape::Tet4);
    for mesh in [mixed, tetrahedra] {
        let volume: f64 = mesh
            .outer_faces()
            .iter()
            .map(|(_, corners)| {
                let [a, b, c, d] = corners.map(|n| mesh.positions[n]);
                let cross = |p: [f64; 3], q: [f64; 3]| {
                    [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]]
                };
                let minus = |p: [f64; 3], q: [f64; 3]| -> [f64; 3] { std::array::from_fn(|i| p[i] - q[i]) };
                let normal = cross(minus(c, a), minus(d, b));
                a.iter().zip(normal).map(|(a, n)| a * n / 6.0).sum::<f64>()
            })
            .sum();
        assert!((volume - 6.0).abs() < 1e-12, "{volume}");
    }
}
