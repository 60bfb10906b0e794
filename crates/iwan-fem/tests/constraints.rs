//! Constraints by elimination: against CalculiX, and against the rigid motions that each constraint must allow or prevent.
#![allow(clippy::unwrap_used, reason = "a failed test may panic")]

use std::path::Path;

use iwan_fem::mesh::block::{block, uniform};
use iwan_fem::mesh::{Constraint, Freedom, GLOBAL, MeshFile, PointMass, Rule, Shape, Weighted, read_bytes};
use iwan_fem::{Assembled, Formulation, Limit, Material, Structure};

use crate::solids::with_middles;

/// Relative tolerance of frequencies: CalculiX prints seven digits.
const DIGITS: f64 = 1e-6;

fn structure(name: &str, bytes: &[u8]) -> Structure {
    let MeshFile { mesh, constraints, masses, sections, .. } = read_bytes(Path::new(name), bytes).unwrap();
    let [young, poisson, density] = sections[0].constants;
    let mut structure = Structure::new(mesh, Material::new(young, poisson, density).unwrap());
    structure.formulation = Formulation::Displacement;
    (structure.constraints, structure.masses) = (constraints, masses);
    assert_eq!(structure.check().message(), None, "{name}");
    structure
}

/// Decks of tests/peers/constraints.py: a tie of meshes that do not match, of bricks and of ten-node tetrahedra, a rigid body with a mass, RBE3.
#[test]
fn decks_with_constraints_have_the_frequencies_of_calculix() {
    let decks: [(&str, &[u8]); 4] = [
        ("tied.inp", include_bytes!("../../../tests/peers/decks/tied.inp")),
        ("tied_tet.inp", include_bytes!("../../../tests/peers/decks/tied_tet.inp")),
        ("rigid.inp", include_bytes!("../../../tests/peers/decks/rigid.inp")),
        ("mean.bdf", include_bytes!("../../../tests/peers/decks/mean.bdf")),
    ];
    let text = include_str!("../../../tests/peers/calculix_constraints.csv");
    for (name, bytes) in decks {
        let line =
            |line: &str| line.strip_prefix(&format!("{name},"))?.split(',').nth(1)?.parse::<f64>().ok();
        let expected: Vec<f64> = text.lines().filter_map(line).collect();
        assert_eq!(expected.len(), 8, "{name}");
        let modes = structure(name, bytes).assemble().and_then(|a| a.modes(Limit::Stuck, 8)).unwrap();
        assert_eq!(modes.zero_modes(), 0, "{name}");
        for (mode, (found, expected)) in modes.frequencies().iter().zip(&expected).enumerate() {
            let error = (found / expected - 1.0).abs();
            assert!(error < DIGITS, "{name} mode {}: {found} against {expected} ({error:.1e})", mode + 1);
        }
    }
}

const STEEL: [f64; 3] = [200.0, 0.3, 7.0];

/// A free bar of 4 x 1 x 1 from 4 x 2 x 2 bricks, with further free nodes beside it.
fn bar(extra: &[[f64; 3]]) -> Structure {
    let mut mesh = block(&[uniform(0.0, 4.0, 4), uniform(0.0, 1.0, 2), uniform(0.0, 1.0, 2)]);
    for point in extra {
        mesh.positions.push(*point);
        mesh.node_labels.push(mesh.positions.len() as u64);
    }
    Structure::new(mesh, Material::new(STEEL[0], STEEL[1], STEEL[2]).unwrap())
}

fn end(structure: &Structure, x: f64) -> Vec<usize> {
    (0..45).filter(|n| structure.mesh.positions[*n][0] == x).collect()
}

fn add(structure: &mut Structure, name: &str, rule: Rule) {
    structure.constraints.push(Constraint { name: name.into(), rule });
}

fn assembled(structure: &Structure) -> Assembled {
    assert_eq!(structure.check().message(), None);
    structure.assemble().unwrap()
}

/// Rigid groups, means, interpolation and a mass with inertia leave the six rigid motions free, and the total mass is the sum of all
/// masses.
#[test]
fn rigid_motions_stay_free_under_constraints_that_allow_them() {
    let mut structure = bar(&[[5.0, 0.3, 0.2], [-1.0, 0.5, 0.9], [2.0, 3.0, 3.0], [2.0, 0.4, 1.0]]);
    let nodes = end(&structure, 4.0);
    let all = [true; 6];
    add(&mut structure, "rigid", Rule::Rigid { reference: 45, nodes, components: all, directions: GLOBAL });
    let weighted = |node| Weighted { node, weight: 1.0 + node as f64, components: [true; 3] };
    let nodes = end(&structure, 0.0).into_iter().map(weighted).collect();
    add(&mut structure, "mean", Rule::Mean { reference: 46, components: all, nodes, directions: GLOBAL });
    // A second reference node follows the first; the third, a point on the top, carries nothing.
    add(
        &mut structure,
        "chain",
        Rule::Rigid { reference: 46, nodes: vec![47], components: all, directions: GLOBAL },
    );
    let on_top = |x: f64, y: f64| (0..45).find(|n| structure.mesh.positions[*n] == [x, y, 1.0]).unwrap();
    let of = vec![(on_top(2.0, 0.0), 0.2), (on_top(2.0, 0.5), 0.8)];
    add(&mut structure, "point", Rule::Interpolated { node: 48, of });
    structure.masses.push(PointMass {
        name: "flywheel".into(),
        node: 45,
        mass: 3.0,
        offset: [0.1, -0.2, 0.3],
        inertia: [[2.0, -0.3, 0.1], [-0.3, 2.5, 0.2], [0.1, 0.2, 3.0]],
    });
    structure.masses.push(PointMass {
        name: "bob".into(),
        node: 47,
        mass: 2.0,
        offset: [0.0; 3],
        inertia: [[0.0; 3]; 3],
    });
    let assembled = assembled(&structure);
    let modes = assembled.modes(Limit::Stuck, 12).unwrap();
    assert_eq!(modes.zero_modes(), 6, "{:?}", modes.frequencies());
    assert!((assembled.total_mass() - (28.0 + 5.0)).abs() < 1e-12);
    // Moment of inertia about the x axis through the origin: ∫(y² + z²) dm of the bar, Steiner's part and the own inertia of the bodies.
    let spin = assembled.rigid_motion(3);
    let inertia = assembled.mass().form(&spin, &spin);
    let (y, z) = (0.3 - 0.2, 0.2 + 0.3);
    let expected = 28.0 * 2.0 / 3.0 + 3.0 * (y * y + z * z) + 2.0 + 2.0 * 18.0;
    assert!((inertia / expected - 1.0).abs() < 1e-12, "{inertia} {expected}");
}

/// The mean of a rigid motion is that motion; the mean of a squeeze whose mean is zero is no motion.
#[test]
fn a_mean_fits_rigid_motions_exactly() {
    let mut structure = bar(&[[5.0, 0.3, 0.2]]);
    let nodes: Vec<Weighted> = end(&structure, 4.0)
        .into_iter()
        .map(|node| Weighted { node, weight: 1.0, components: [true; 3] })
        .collect();
    add(
        &mut structure,
        "mean",
        Rule::Mean { reference: 45, components: [true; 6], nodes, directions: GLOBAL },
    );
    let assembled = assembled(&structure);
    for motion in 0..6 {
        let x = assembled.displacements(&assembled.rigid_motion(motion));
        let p = structure.mesh.positions[45];
        let mut expected = [0.0; 3];
        match motion {
            0..3 => expected[motion] = 1.0,
            3 => expected = [0.0, -p[2], p[1]],
            4 => expected = [p[2], 0.0, -p[0]],
            _ => expected = [-p[1], p[0], 0.0],
        }
        for axis in 0..3 {
            assert!(
                (x[135 + axis] - expected[axis]).abs() < 1e-12,
                "{motion} {axis}: {} {}",
                x[135 + axis],
                expected[axis]
            );
        }
    }
}

/// Equations between nodes that already follow a mean: the elimination finds an unknown that is still free, and the equation holds in every
/// mode.
#[test]
fn equations_hold_in_every_mode() {
    let mut structure = bar(&[[5.0, 0.5, 0.5], [-1.0, 0.5, 0.5]]);
    for (reference, x) in [(45, 4.0), (46, 0.0)] {
        let nodes =
            end(&structure, x).into_iter().map(|node| Weighted { node, weight: 1.0, components: [true; 3] });
        let rule =
            Rule::Mean { reference, components: [true; 6], nodes: nodes.collect(), directions: GLOBAL };
        add(&mut structure, "mean", rule);
    }
    for component in [0, 1, 3] {
        let at = |node| Freedom { node, component };
        add(&mut structure, "equal", Rule::Equation(vec![(at(45), 1.0), (at(46), -1.0)]));
    }
    // The same equation a second time: it holds already, and eliminates nothing more.
    let at = |node| Freedom { node, component: 0 };
    add(&mut structure, "again", Rule::Equation(vec![(at(45), 2.0), (at(46), -2.0)]));
    let assembled = assembled(&structure);
    assert_eq!(assembled.unknowns(), 3 * 45 - 3);
    let modes = assembled.modes(Limit::Stuck, 10).unwrap();
    for mode in 0..10 {
        let x = assembled.displacements(modes.shape(mode));
        let size = x.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        for axis in 0..2 {
            assert!((x[135 + axis] - x[138 + axis]).abs() < 1e-9 * size, "mode {mode} axis {axis}");
        }
    }
}

#[test]
fn constraints_that_cannot_be_obeyed_are_refused_by_name() {
    let refused = |rule: Rule, expected: &str| {
        let mut structure = bar(&[[5.0, 0.5, 0.5]]);
        add(&mut structure, "*THIS of line 3", rule);
        let error = structure.assemble().map(|_| ()).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}\n{expected}");
    };
    let turning = Rule::Equation(vec![(Freedom { node: 3, component: 4 }, 1.0)]);
    refused(turning, "*THIS of line 3: it has a rotation of node 4, which has none");
    let weighted = |node| Weighted { node, weight: 1.0, components: [true; 3] };
    let edge = bar(&[]).mesh.positions.into_iter().enumerate().filter(|(_, p)| p[1] == 0.0 && p[2] == 0.0);
    let on_a_line = edge.map(|(node, _)| weighted(node)).collect();
    let rule = Rule::Mean { reference: 45, components: [true; 6], nodes: on_a_line, directions: GLOBAL };
    refused(rule, "*THIS of line 3: its 5 nodes are on one line or fewer than three");
    let mut structure = bar(&[]);
    let inertia = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    structure.masses.push(PointMass {
        name: "CONM2 5".into(),
        node: 0,
        mass: 1.0,
        offset: [0.0; 3],
        inertia,
    });
    let error = structure.assemble().map(|_| ()).unwrap_err().to_string();
    assert!(
        error.contains("CONM2 5: it has inertia or an offset, but its node 1 has no rotations"),
        "{error}"
    );
}

/// The tolerance without a given one is a twentieth of the faces' diagonal, √2/20 = 0.071 here, for faces with mid-edge nodes too: it was 0.106.
#[test]
fn a_tie_leaves_nodes_beyond_a_twentieth_of_the_faces_free() {
    let mut mesh = block(&[uniform(0.0, 2.0, 2), uniform(0.0, 1.0, 1), uniform(0.0, 1.0, 1)]);
    with_middles(&mut mesh, Shape::Hex20);
    mesh.node_sets
        .insert("lead".into(), (0..mesh.positions.len()).filter(|n| mesh.positions[*n][2] == 1.0).collect());
    let first = mesh.positions.len();
    let gaps = [0.05, 0.068, 0.074, 0.1];
    mesh.positions.extend(gaps.map(|gap| [0.5, 0.5, 1.0 + gap]));
    mesh.node_labels.extend([1001, 1002, 1003, 1004]);
    mesh.node_sets.insert("follow".into(), (first..first + gaps.len()).collect());
    let mut structure = Structure::new(mesh, Material::new(STEEL[0], STEEL[1], STEEL[2]).unwrap());
    let (moved, free) = structure.project("glue", "follow", "lead", None).unwrap();
    assert!((moved - 0.068).abs() < 1e-12 && free == 2, "{moved} {free}");
}

/// Two blocks whose meshes do not match: a linear field passes through the tie exactly, and the tie adds no stiffness elsewhere.
#[test]
fn a_tie_by_projection_passes_the_patch_test_where_faces_follow_the_finer_side() {
    let mut mesh = block(&[uniform(0.0, 2.0, 2), uniform(0.0, 1.0, 1), uniform(0.0, 1.0, 1)]);
    let upper = block(&[uniform(0.0, 2.0, 5), uniform(0.0, 1.0, 3), uniform(1.0, 2.0, 1)]);
    let first = mesh.positions.len();
    mesh.positions
        .extend(upper.positions.iter().map(|p| [p[0], p[1], if p[2] == 1.0 { 1.001 } else { p[2] }]));
    mesh.node_labels.extend(upper.node_labels.iter().map(|label| label + 1000));
    mesh.elements.extend(upper.elements.into_iter().map(|mut element| {
        element.label += 1000;
        element.nodes.iter_mut().for_each(|node| *node += first);
        element
    }));
    let count = mesh.positions.len();
    mesh.node_sets.insert("lead".into(), (0..first).filter(|n| mesh.positions[*n][2] == 1.0).collect());
    mesh.node_sets
        .insert("follow".into(), (first..count).filter(|n| mesh.positions[*n][2] == 1.001).collect());
    let mut structure = Structure::new(mesh, Material::new(STEEL[0], STEEL[1], STEEL[2]).unwrap());
    let (moved, free) = structure.project("glue", "follow", "lead", None).unwrap();
    assert!((moved - 0.001).abs() < 1e-12 && free == 0);
    let assembled = assembled(&structure);
    assert_eq!(assembled.modes(Limit::Stuck, 8).unwrap().zero_modes(), 6);
    // The field u = G x in the unknowns: the displacements of all nodes that follow no others.
    let field =
        |p: &[f64; 3]| [1e-3 * p[0] + 2e-4 * p[1], 4e-4 * p[0] - 2e-3 * p[2], 5e-4 * p[1] + 7e-4 * p[2]];
    let y: Vec<f64> = (0..assembled.unknowns())
        .map(|j| match assembled.unknown(j) {
            iwan_fem::Unknown::Displacement { node, axis } => field(&structure.mesh.positions[node])[axis],
            other => panic!("{other:?}"),
        })
        .collect();
    for (node, u) in assembled.displacements(&y).chunks_exact(3).enumerate() {
        let expected = field(&structure.mesh.positions[node]);
        assert!((0..3).all(|a| (u[a] - expected[a]).abs() < 1e-15), "node {node}");
    }
    let error = structure.project("glue", "nowhere", "lead", None).unwrap_err().to_string();
    assert!(error.contains("refers to the node set `nowhere`"), "{error}");
}
