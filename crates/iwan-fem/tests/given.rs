//! Matrices in place of elements: the same structure made in two ways, closed forms, and faulty matrices that are refused.
#![allow(clippy::unwrap_used, reason = "a failed test may panic")]

use std::f64::consts::PI;
use std::sync::Arc;

use iwan_core::{Jenkins, Pulse};
use iwan_fem::mesh::Mesh;
use iwan_fem::mesh::beam::Configuration;
use iwan_fem::{
    Assembled, Basis, Given, Interface, Joint, Law, Limit, Material, NamedModes, Patch, Recovered,
    RelativeSlip, Representation, Row, SlipGroup, SlipStatics, Structure, Symmetric, Transient, paper,
};

/// The paper's beam, and the same structure with matrices in place of its elements.
fn twins(configuration: Configuration) -> [Structure; 2] {
    let meshed = paper::structure(configuration, 1).unwrap();
    let bare = Structure { joints: Vec::new(), ..meshed.clone() }.assemble().unwrap();
    let rows = (0..bare.unknowns()).map(|j| Row::Displacement { node: j / 3, axis: j % 3 }).collect();
    let (stiffness, mass) = (bare.slipping_stiffness().clone(), bare.mass().clone());
    let given = Structure {
        given: Some(Given {
            rows,
            stiffness,
            mass,
            damping: None,
            placed: true,
            recovered: vec![],
            relative: vec![],
        }),
        ..meshed.clone()
    };
    [meshed, given]
}

#[test]
fn matrices_of_a_mesh_give_its_frequencies() {
    for configuration in [Configuration::A, Configuration::B] {
        let [meshed, given] = twins(configuration).map(|structure| structure.assemble().unwrap());
        assert_eq!(meshed.unknowns(), given.unknowns());
        assert!((meshed.total_mass() / given.total_mass() - 1.0).abs() < 1e-12);
        for limit in [Limit::Stuck, Limit::Slipping] {
            let (a, b) = (meshed.modes(limit, 30).unwrap(), given.modes(limit, 30).unwrap());
            // With all joints slipping, the link slides freely along the direction of each of its joints.
            assert_eq!(a.zero_modes(), b.zero_modes());
            for (a, b) in a.frequencies().iter().zip(b.frequencies()).skip(a.zero_modes()) {
                assert!((a / b - 1.0).abs() < 1e-8, "{a} {b}");
            }
        }
    }
}

#[test]
fn a_ring_down_with_joints_is_that_of_the_mesh() {
    let acceleration = |structure: &Structure| {
        let assembled = structure.assemble().unwrap();
        let task = Transient {
            dt: 1e-5,
            steps: 300,
            pulse: Pulse::Haversine { amplitude: 300.0, duration: 1.6e-3 },
            load: assembled.load("tip", [0.0, 0.0, 1.0]).unwrap(),
            initial_velocity: None,
            representation: Representation::DEFAULT_IN_A_STRUCTURE,
            outputs: vec![assembled.output("tip", "tip", [0.0, 0.0, 1.0]).unwrap()],
        };
        let reduced = assembled.reduce(20, Basis::default()).unwrap().transient(&task).unwrap();
        let full = assembled.transient(&task).unwrap();
        [reduced, full].map(|response| response.outputs[0].acceleration.clone())
    };
    let [meshed, given] = twins(Configuration::A);
    // Attachment vectors of the reduced model belong to K + shift M, and the two structures find the shift in different ways. So the two
    // reduced models differ by the part that twenty modes leave out; the full models agree.
    let tolerances = [1e-3, 1e-9];
    for ((a, b), tolerance) in acceleration(&meshed).iter().zip(acceleration(&given)).zip(tolerances) {
        let peak = a.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let off = a.iter().zip(&b).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
        assert!(peak > 100.0 && off < tolerance * peak, "{off:e} of {peak}");
    }
}

/// Masses 2 and 3 on springs 800 and 500 to the ground, with a joint of stiffness 900 between them, and no positions.
fn pair() -> Structure {
    let mesh = Mesh {
        positions: vec![[0.0; 3]; 2],
        node_labels: vec![5, 9],
        node_sets: [("a".to_owned(), vec![0]), ("b".to_owned(), vec![1])].into(),
        ..Mesh::default()
    };
    let rows = vec![Row::Displacement { node: 0, axis: 0 }, Row::Displacement { node: 1, axis: 0 }];
    let stiffness = Symmetric::diagonal(vec![800.0, 500.0]);
    let mass = Symmetric::diagonal(vec![2.0, 3.0]);
    let mut structure = Structure::new(mesh, Material::new(1.0, 0.0, 1.0).unwrap());
    structure.given = Some(Given {
        rows,
        stiffness,
        mass,
        damping: None,
        placed: false,
        recovered: vec![],
        relative: vec![],
    });
    let law: Law = Arc::new(Jenkins::new(900.0, 1.0).unwrap());
    structure.joints =
        vec![Joint::new("bolt", "a", "b", Interface::Directions).slip([1.0, 0.0, 0.0], Some(law))];
    structure
}

/// Frequencies of two masses by the closed form, Hz.
fn two_masses(k: [f64; 3], m: [f64; 2]) -> [f64; 2] {
    let (a, b, c) = (k[0] + k[2], k[1] + k[2], -k[2]);
    let (p, q) = (a / m[0] + b / m[1], (a * b - c * c) / (m[0] * m[1]));
    [-1.0, 1.0].map(|sign| (0.5 * (p + sign * (p * p - 4.0 * q).sqrt())).sqrt() / (2.0 * PI))
}

#[test]
fn a_joint_between_two_masses_has_the_frequencies_of_the_closed_form() {
    let structure = pair();
    assert_eq!(structure.check().message(), None);
    let assembled = structure.assemble().unwrap();
    for (limit, k) in [(Limit::Stuck, 900.0), (Limit::Slipping, 0.0)] {
        let modes = assembled.modes(limit, 2).unwrap();
        assert_eq!(modes.zero_modes(), 0);
        for (found, expected) in modes.frequencies().iter().zip(two_masses([800.0, 500.0, k], [2.0, 3.0])) {
            assert!((found / expected - 1.0).abs() < 1e-12, "{limit:?} {found} {expected}");
        }
    }
}

/// The motion of the second mass by a generalised coordinate q, x_2 = x_1 + 0.3 q, beside a rotation that is a third oscillator.
#[test]
fn rotations_and_generalised_coordinates_are_unknowns() {
    let mut structure = pair();
    structure.joints.clear();
    let given = structure.given.as_mut().unwrap();
    let (k, m, t) = ([800.0, 500.0], [2.0, 3.0], 0.3);
    given.rows =
        vec![Row::Displacement { node: 0, axis: 0 }, Row::Generalised, Row::Rotation { node: 1, axis: 2 }];
    let lower = |a: f64, b: f64, c: f64| vec![(0, 0, a + b), (1, 0, t * b), (1, 1, t * t * b), (2, 2, c)];
    given.stiffness = Symmetric::from_lower(3, lower(k[0], k[1], 90.0));
    given.mass = Symmetric::from_lower(3, lower(m[0], m[1], 1.0));
    let assembled = structure.assemble().unwrap();
    let modes = assembled.modes(Limit::Stuck, 3).unwrap();
    let mut expected = vec![(k[0] / m[0]).sqrt(), (k[1] / m[1]).sqrt(), 90.0_f64.sqrt()];
    expected.sort_by(f64::total_cmp);
    for (found, expected) in modes.frequencies().iter().zip(expected) {
        assert!((found * 2.0 * PI / expected - 1.0).abs() < 1e-12, "{found} {expected}");
    }
    // The displacement of node 9 has no row, so node 9 does not move. That of node 5 moves only in the modes of the two masses.
    let moved = assembled.displacements(modes.shape(0));
    assert_eq!(moved[3..], [0.0; 3]);
}

#[test]
fn without_positions_there_are_no_rigid_rotations_and_a_free_structure_has_its_zero_mode() {
    let mut structure = pair();
    structure.given.as_mut().unwrap().stiffness =
        Symmetric::from_lower(2, vec![(0, 0, 700.0), (1, 0, -700.0), (1, 1, 700.0)]);
    let assembled = structure.assemble().unwrap();
    let modes = assembled.modes(Limit::Stuck, 2).unwrap();
    assert_eq!(modes.zero_modes(), 1);
    let expected = (1600.0_f64 * (1.0 / 2.0 + 1.0 / 3.0)).sqrt() / (2.0 * PI);
    assert!((modes.frequency(1) / expected - 1.0).abs() < 1e-10);
    assert!((assembled.total_mass() - 5.0).abs() < 1e-14);
    let remarks: Vec<String> = structure.check().remarks.iter().map(ToString::to_string).collect();
    assert!(
        remarks[0].contains("joint `bolt`: nodes 5 and 9 on its two sides belong to one part"),
        "{remarks:?}"
    );
}

#[test]
fn matrices_that_no_structure_has_are_refused_with_row_node_and_value() {
    let message = |change: &dyn Fn(&mut Structure)| {
        let mut structure = pair();
        change(&mut structure);
        structure.check().message().unwrap_or_default()
    };
    let negative = message(&|s| s.given.as_mut().unwrap().mass = Symmetric::diagonal(vec![2.0, -3.0]));
    assert!(
        negative.starts_with("mass, row 2 (node 9, x): the diagonal entry is -3e0, below 0; check"),
        "{negative}"
    );
    let indefinite = message(&|s| {
        s.given.as_mut().unwrap().stiffness =
            Symmetric::from_lower(2, vec![(0, 0, 4.0), (1, 1, 9.0), (1, 0, -7.0)]);
    });
    assert!(
        indefinite
            .contains("stiffness, row 2 (node 9, x): the entry with row 1 (node 5, x) is -7e0, larger than")
            && indefinite.contains("6e0"),
        "{indefinite}"
    );
    let idle = message(&|s| {
        let given = s.given.as_mut().unwrap();
        (given.stiffness, given.mass) =
            (Symmetric::diagonal(vec![4.0, 0.0]), Symmetric::diagonal(vec![1.0, 0.0]));
    });
    assert!(idle.contains("stiffness and mass, row 2 (node 9, x): both diagonal entries are 0"), "{idle}");
    let itself = message(&|s| s.joints[0].patch = "a".into());
    assert!(itself.contains("joint `bolt`: both sides begin with node 5"), "{itself}");
    let rigid = message(&|s| s.joints[0].interface = Interface::Whole(Patch::Rigid));
    assert!(rigid.contains("it needs the positions of its nodes, and the matrices come without"), "{rigid}");
    let mut held = pair();
    held.joints[0].interface = Interface::NodeToNode;
    let error = held.assemble().unwrap_err().to_string();
    assert!(
        error.contains("node 5: its motion along y is given by the matrices, which have no row for it,"),
        "{error}"
    );
}

/// A condensed mass couples unknowns that the stiffness does not: the order of elimination takes both patterns into account.
#[test]
fn a_mass_with_entries_that_the_stiffness_has_not() {
    let mut structure = pair();
    structure.joints.clear();
    let given = structure.given.as_mut().unwrap();
    given.mass = Symmetric::from_lower(2, vec![(0, 0, 2.0), (1, 0, 0.5), (1, 1, 3.0)]);
    let found = structure.assemble().unwrap().modes(Limit::Stuck, 2).unwrap().frequencies();
    // det(K - λ M) = 0 with K = diag(800, 500), M = [2 1/2; 1/2 3].
    let (a, b, c): (f64, f64, f64) = (2.0 * 3.0 - 0.25, -(800.0 * 3.0 + 500.0 * 2.0), 800.0 * 500.0);
    let root = (b * b - 4.0 * a * c).sqrt();
    for (found, sign) in found.iter().zip([-1.0, 1.0]) {
        let expected = ((-b + sign * root) / (2.0 * a)).sqrt() / (2.0 * PI);
        assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
    }
}

/// A given damping acts on each coordinate of a reduced model by its diagonal entry; the full model refuses a given damping.
#[test]
fn given_damping_is_obeyed_or_refused() {
    let mut structure = pair();
    let given = structure.given.as_mut().unwrap();
    // C = α M + β K with all joints slipping is diagonal in the modes of that state, with the entries α + β ω².
    let (alpha, beta) = (0.3, 1e-3);
    given.damping = Some(Symmetric::diagonal(vec![alpha * 2.0 + beta * 800.0, alpha * 3.0 + beta * 500.0]));
    structure.joints.clear();
    let assembled = structure.assemble().unwrap();
    let reduced = assembled.reduce(2, Basis::default()).unwrap();
    for (damping, eigenvalue) in reduced.damping().iter().zip(reduced.eigenvalues()) {
        assert!((damping / (alpha + beta * eigenvalue) - 1.0).abs() < 1e-12, "{damping} {eigenvalue}");
    }
    let twice = reduced.with_damping(|_| 0.01).unwrap();
    let expected = alpha + beta * twice.eigenvalues()[1] + 0.02 * twice.eigenvalues()[1].sqrt();
    assert!((twice.damping()[1] / expected - 1.0).abs() < 1e-12);
    let task = Transient {
        dt: 1e-4,
        steps: 10,
        pulse: Pulse::None,
        load: vec![0.0; 2],
        initial_velocity: Some(vec![1.0, 0.0]),
        representation: Representation::DEFAULT_IN_A_STRUCTURE,
        outputs: Vec::new(),
    };
    let error = assembled.transient(&task).unwrap_err().to_string();
    assert!(error.contains("the full model knows no viscous damping"), "{error}");
}

/// One tetrahedron of ten nodes: its mass, integrated at four points, moves in 12 motions, and a search for more modes ends with an error
/// in words.
#[test]
fn more_modes_than_the_mass_moves_are_refused() {
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let mut positions = corners.to_vec();
    for (a, b) in [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)] {
        positions.push(std::array::from_fn(|i| 0.5 * (corners[a][i] + corners[b][i])));
    }
    let element =
        iwan_fem::mesh::Element { label: 1, shape: iwan_fem::mesh::Shape::Tet10, nodes: (0..10).collect() };
    let mesh =
        Mesh { node_labels: (1..=10).collect(), positions, elements: vec![element], ..Mesh::default() };
    let structure = Structure::new(mesh, Material::new(1.0, 0.3, 1.0).unwrap());
    let assembled = structure.assemble().unwrap();
    let error = assembled.modes(Limit::Stuck, 30).unwrap_err().to_string();
    assert!(error.contains("modes") && error.contains(';'), "{error}");
}

/// The same masses and springs, with the joint as a row of relative displacements. Node 9 moves along y by half of the displacement of node
/// 5, plus twice its own displacement along x.
fn pair_by_rows() -> Structure {
    let mut structure = pair();
    let law = structure.joints.remove(0).slips.remove(0).law;
    let given = structure.given.as_mut().unwrap();
    given.relative =
        vec![RelativeSlip { name: "bolt".into(), terms: vec![(0, -1.0), (1, 1.0)], law, to_ground: false }];
    given.recovered = vec![Recovered { node: 1, axis: 1, terms: vec![(0, 0.5), (1, 2.0)] }];
    structure
}

#[test]
fn a_joint_between_rows_is_the_joint_between_their_nodes() {
    let structure = pair_by_rows();
    assert_eq!(structure.check().message(), None);
    let assembled = structure.assemble().unwrap();
    assert_eq!(assembled.slips()[0].name, "bolt");
    for (limit, k) in [(Limit::Stuck, 900.0), (Limit::Slipping, 0.0)] {
        let modes = assembled.modes(limit, 2).unwrap();
        for (found, expected) in modes.frequencies().iter().zip(two_masses([800.0, 500.0, k], [2.0, 3.0])) {
            assert!((found / expected - 1.0).abs() < 1e-12, "{limit:?} {found} {expected}");
        }
        // The slip is the row's combination of the displacements, and a combination of rows gives the displacements again.
        let apart = assembled.combination(&[(0, -1.0), (1, 1.0)]).unwrap();
        for index in 0..2 {
            let (shape, u) = (modes.shape(index), assembled.displacements(modes.shape(index)));
            assert!((shape[assembled.slips()[0].unknown] - (u[3] - u[0])).abs() < 1e-14, "{u:?}");
            assert!((dot(&apart, shape) - (u[3] - u[0])).abs() < 1e-14, "{u:?}");
            assert!((u[4] - (0.5 * u[0] + 2.0 * u[3])).abs() < 1e-14, "{u:?}");
        }
    }
    let words = format!("{:?}", structure.given.unwrap().relative);
    assert!(words.contains("bolt") && words.contains("(1, 1.0)"), "{words}");
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[test]
fn rows_that_no_joint_and_no_recovery_has_are_refused() {
    let refused = |change: &dyn Fn(&mut Given)| {
        let mut structure = pair_by_rows();
        change(structure.given.as_mut().unwrap());
        structure.assemble().unwrap_err().to_string()
    };
    for terms in [vec![(0, 1.0), (7, -1.0)], vec![(0, 0.0)], vec![(0, f64::NAN)], Vec::new()] {
        let message = refused(&|given| given.relative[0].terms = terms.clone());
        assert!(
            message.starts_with("joint `bolt`: its row is all 0, has a column without a row, or a number"),
            "{message}"
        );
    }
    let message = refused(&|given| given.recovered[0].terms = vec![(2, 1.0)]);
    assert!(message.starts_with("the recovery matrix: it has a column without a row"), "{message}");
    let assembled = pair_by_rows().assemble().unwrap();
    let message = assembled.combination(&[(2, 1.0)]).unwrap_err().to_string();
    assert!(message.contains("there is no row 3 among 2; name rows of the matrices"), "{message}");
    let message = assembled.combination(&[(0, f64::NAN)]).unwrap_err().to_string();
    assert!(message.contains("coefficient = NaN is out of range"), "{message}");
    let message = paper::structure(Configuration::A, 1).unwrap().assemble().unwrap().combination(&[(0, 1.0)]);
    assert!(message.unwrap_err().to_string().contains("the structure has elements, and no given matrices"));
}

/// A relative displacement does not change in a motion of the whole structure, unless the joint is one to the ground.
#[test]
fn a_sign_that_is_turned_in_a_row_is_found() {
    let mut structure = pair_by_rows();
    structure.given.as_mut().unwrap().relative[0].terms[0].1 = 1.0;
    let message = structure.check().message().unwrap();
    assert!(
        message
            .contains("joint `bolt`: moving everything by 1 along x moves its relative displacement by 2e0"),
        "{message}"
    );
    structure.given.as_mut().unwrap().relative[0].to_ground = true;
    assert_eq!(structure.check().message(), None);
    // The joint then resists x_1 + x_2 with the stiffness 900: K = [1700 900; 900 1400].
    let modes = structure.assemble().unwrap().modes(Limit::Stuck, 2).unwrap();
    for (found, expected) in modes.frequencies().iter().zip(two_masses([800.0, 500.0, 900.0], [2.0, 3.0])) {
        assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
    }
}

/// Masses 2 and 3 each contribute their own inertia force when the base is accelerated; no row moves along y.
#[test]
fn a_base_pulls_at_every_mass() {
    for structure in [pair(), pair_by_rows()] {
        let assembled = structure.assemble().unwrap();
        let modes = assembled.modes(Limit::Stuck, 2).unwrap();
        let force = assembled.base_force([1.5, 0.0, 0.0]).unwrap();
        for index in 0..2 {
            let u = assembled.displacements(modes.shape(index));
            let expected = -1.5 * (2.0 * u[0] + 3.0 * u[3]);
            assert!((dot(&force, modes.shape(index)) - expected).abs() < 1e-13, "{expected}");
        }
        assert!(assembled.base_force([0.0, 1.0, 0.0]).unwrap().iter().all(|f| *f == 0.0));
        for (direction, words) in [
            ([0.0; 3], "length of the direction = 0 is out of range: must be > 0"),
            ([1.0, f64::NAN, 0.0], "direction = NaN is out of range: must be finite"),
        ] {
            let message = assembled.base_force(direction).unwrap_err().to_string();
            assert_eq!(message, words);
        }
    }
}

/// x_2 = x_1 + 0.3 q, beside a rotation: M ι is the first column of the mass matrix, and a motion of the base has no effect on a rotation.
#[test]
fn generalised_coordinates_feel_the_base_by_their_mass() {
    let mut structure = pair();
    structure.joints.clear();
    let given = structure.given.as_mut().unwrap();
    given.rows =
        vec![Row::Displacement { node: 0, axis: 0 }, Row::Generalised, Row::Rotation { node: 1, axis: 2 }];
    let lower = |a: f64, b: f64, c: f64| vec![(0, 0, a + b), (1, 0, 0.3 * b), (1, 1, 0.09 * b), (2, 2, c)];
    given.stiffness = Symmetric::from_lower(3, lower(800.0, 500.0, 90.0));
    given.mass = Symmetric::from_lower(3, lower(2.0, 3.0, 1.0));
    let force = structure.assemble().unwrap().base_force([1.0, 0.0, 0.0]).unwrap();
    let mut sorted = force.clone();
    sorted.sort_by(f64::total_cmp);
    for (found, expected) in sorted.iter().zip([-5.0, -0.9, 0.0]) {
        assert!((found - expected).abs() < 1e-14, "{force:?}");
    }
}

/// Flexibility of the two masses with the joint stuck: the inverse of [1700 -900; -900 1400].
const FLEXIBILITY: [[f64; 2]; 2] = [[1400.0 / 1.57e6, 900.0 / 1.57e6], [900.0 / 1.57e6, 1700.0 / 1.57e6]];

fn force_on_the_first(assembled: &Assembled) -> Vec<f64> {
    assembled.combination(&[(0, 1.0)]).unwrap()
}

/// The compliance of a slip that few modes leave out under static forces is its whole compliance minus the part of these modes; all modes
/// together leave nothing out.
#[test]
fn compliance_is_what_the_modes_leave_out() {
    let structure = pair_by_rows();
    let named = NamedModes::new(&structure, 2).unwrap();
    let flexibility = named.slip_flexibility(force_on_the_first(&named.assembled)).unwrap();
    let [[a, b], [_, c]] = FLEXIBILITY;
    let (slip, at_force) = (a - 2.0 * b + c, b - a);
    let whole = flexibility.beside(&[]);
    assert!((whole.compliance[0][0] / slip - 1.0).abs() < 1e-9, "{whole:?}");
    assert!((whole.at_force[0] / at_force - 1.0).abs() < 1e-9, "{whole:?}");
    assert!(whole.participation[0].is_empty());
    let first = flexibility.beside(&named.elastic[..1]);
    let omega = std::f64::consts::TAU * named.frequency_stuck(&named.elastic[0]);
    let own = first.participation[0][0].powi(2) / omega.powi(2);
    assert!((first.compliance[0][0] / (slip - own) - 1.0).abs() < 1e-9, "{first:?}");
    let all = flexibility.beside(&named.elastic);
    assert!(all.compliance[0][0].abs() < 1e-9 * slip && all.at_force[0].abs() < 1e-9 * slip, "{all:?}");
    let message = named.slip_flexibility(vec![0.0; 3]).unwrap_err().to_string();
    assert!(message.contains("the load has 3 entries, the structure has 2 unknowns"), "{message}");
}

/// Slips 0 and 1 are the two ends of one link, slip 2 hardly moves, and slip 3 moves independently.
#[test]
fn slips_that_move_alike_are_one() {
    let statics = SlipStatics {
        participation: vec![vec![1.0, 0.5], vec![-1.003, -0.5], vec![0.004, 0.0], vec![0.3, 0.1]],
        compliance: vec![
            vec![4.0, -1.0, 0.0, 0.5],
            vec![-1.0, 2.0, 0.0, 0.25],
            vec![0.0; 4],
            vec![0.5, 0.25, 0.0, 3.0],
        ],
        at_force: vec![0.2, -0.4, 0.0, 0.7],
    };
    let (groups, stuck) = statics.groups(&[0, 1, 2, 3], &|_, _| true);
    let [link, other] = [vec![(0, 1.0), (1, -1.0)], vec![(3, 1.0)]].map(|members| SlipGroup { members });
    assert_eq!((groups.as_slice(), stuck.as_slice()), ([link, other].as_slice(), [2].as_slice()));
    let joined = statics.of_groups(&groups);
    // Means with signs: (4 + 1 + 1 + 2)/4 within the group of the two ends, (0.5 - 0.25)/2 between this group and the third slip.
    assert_eq!(joined.compliance, [[2.0, 0.125], [0.125, 3.0]]);
    assert!((joined.participation[0][0] - 1.0015).abs() < 1e-15 && joined.participation[0][1] == 0.5);
    assert!((joined.at_force[0] - 0.3).abs() < 1e-15 && joined.at_force[1] == 0.7);
    // Slips with different laws stay separate joints, however alike they move.
    assert_eq!(statics.groups(&[0, 1], &|_, _| false).0.len(), 2);
}

/// The sum of the receptances of the coordinates is that of the two masses: the inverse of K - ω² M with the joint stuck.
#[test]
fn steady_coordinates_have_the_receptance_of_the_closed_form() {
    let structure = pair_by_rows();
    let assembled = structure.assemble().unwrap();
    let reduced = assembled.reduce(2, Basis::default()).unwrap().with_damping(|_| 0.02).unwrap();
    let [load, output] = [0, 1].map(|row| assembled.combination(&[(row, 1.0)]).unwrap());
    let model = reduced.steady_model(&load, &output).unwrap();
    assert!(model.coordinates.iter().all(|c| (c.damping_ratio - 0.02).abs() < 1e-15), "{model:?}");
    for omega in [0.0_f64, 3.0, 17.0, 60.0] {
        let at = |c: &iwan_fem::SteadyCoordinate| c.at_force / (c.omega.powi(2) - omega.powi(2));
        let found: f64 = model.coordinates.iter().map(|c| at(c) * c.at_output).sum();
        let (a, b) = (1700.0 - 2.0 * omega.powi(2), 1400.0 - 3.0 * omega.powi(2));
        let expected = 900.0 / (a * b - 900.0 * 900.0);
        assert!((found / expected - 1.0).abs() < 1e-10, "{omega}: {found} {expected}");
        let slip: f64 =
            model.coordinates.iter().zip(&model.slips[0].participation).map(|(c, b)| at(c) * b).sum();
        let expected = (900.0 - b) / (a * b - 900.0 * 900.0);
        assert!((slip / expected - 1.0).abs() < 1e-10, "{omega}: {slip} {expected}");
    }
    assert!(format!("{:?}", model.slips[0]).contains("bolt"));
    let message = reduced.steady_model(&load, &[0.0]).unwrap_err().to_string();
    assert!(message.contains("a load or output has 1 entries, the structure has 2 unknowns"), "{message}");
    let heavy = {
        let mut structure = pair_by_rows();
        structure.given.as_mut().unwrap().damping = Some(Symmetric::diagonal(vec![300.0, 300.0]));
        structure
    };
    let assembled = heavy.assemble().unwrap();
    let message = assembled.reduce(2, Basis::default()).unwrap().steady_model(&load, &output).unwrap_err();
    assert!(message.to_string().contains("modal damping ratio"), "{message}");
}

/// C = [4 -2; -2 9] in the modes of two masses that nothing connects: the coupling is 2/√(4·9) of the modes' own damping.
#[test]
fn damping_that_couples_modes_is_told() {
    let mut structure = pair();
    structure.joints.clear();
    let given = structure.given.as_mut().unwrap();
    given.damping = Some(Symmetric::from_lower(2, vec![(0, 0, 4.0), (1, 0, -2.0), (1, 1, 9.0)]));
    let warnings = NamedModes::new(&structure, 2).unwrap().warnings();
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert!(warnings[0].contains("couples other 2 and other 1 by 0.33 of their own"), "{warnings:?}");
    let given = structure.given.as_mut().unwrap();
    given.damping = Some(Symmetric::from_lower(2, vec![(0, 0, 4.0), (1, 0, -0.5), (1, 1, 9.0)]));
    assert_eq!(NamedModes::new(&structure, 2).unwrap().warnings(), Vec::<String>::new());
    let message = NamedModes::new(&structure, 41).unwrap_err().to_string();
    assert!(message.contains("41 modes were asked for, the structure has 2 unknowns"), "{message}");
}
