//! Joints, ties and supports that must behave as mechanics requires, and others that must be refused by name.
#![allow(clippy::unwrap_used, reason = "a failed test may panic")]

use std::sync::Arc;

use iwan_core::Jenkins;
use iwan_fem::mesh::beam::Configuration;
use iwan_fem::mesh::block::{block, uniform};
use iwan_fem::{
    Adjustable, Basis, Correction, Error, Interface, Joint, Law, Limit, Lump, Material, NamedModes, Patch,
    Slip, Structure, Support, paper,
};
use iwan_machine::Kind;

/// Two blocks of 2 x 1 x 1, end to end at x = 2, with the sets `left` and `right` of the nodes on either side.
fn two_blocks() -> Structure {
    let material = Material::new(1000.0, 0.3, 1.0).unwrap();
    let half = |from: f64| block(&[uniform(from, from + 2.0, 4), uniform(0.0, 1.0, 2), uniform(0.0, 1.0, 2)]);
    let (mut mesh, other) = (half(0.0), half(2.0));
    let first = mesh.positions.len();
    for (element, label) in other.elements.iter().zip(100..) {
        let mut element = element.clone();
        element.label = label;
        element.nodes.iter_mut().for_each(|node| *node += first);
        mesh.elements.push(element);
    }
    mesh.node_labels.extend((0..other.positions.len() as u64).map(|i| 1000 + i));
    mesh.positions.extend(other.positions);
    let at = |x: f64, range: std::ops::Range<usize>| -> Vec<usize> {
        range.filter(|&i| mesh.positions[i][0] == x).collect()
    };
    let all = mesh.positions.len();
    let sets = [("left", at(2.0, 0..first)), ("right", at(2.0, first..all)), ("end", at(0.0, 0..first))];
    mesh.node_sets.extend(sets.map(|(name, nodes)| (name.to_owned(), nodes)));
    mesh.node_sets.insert("line".into(), vec![0, 1]);
    mesh.node_sets.insert("empty".into(), vec![]);
    Structure::new(mesh, material)
}

fn frequencies(structure: &Structure, contact: Limit) -> (usize, Vec<f64>) {
    let modes = structure.assemble().unwrap().modes(contact, 16).unwrap();
    (modes.zero_modes(), modes.frequencies())
}

/// Two blocks tied node to node without slips behave as one block.
#[test]
fn a_tie_of_matching_meshes_is_one_block() {
    let mut tied = two_blocks();
    tied.joints.push(Joint::new("tie", "right", "left", Interface::NodeToNode));
    let whole = block(&[uniform(0.0, 4.0, 8), uniform(0.0, 1.0, 2), uniform(0.0, 1.0, 2)]);
    let (zero, of_tied) = frequencies(&tied, Limit::Stuck);
    let (_, of_whole) = frequencies(&Structure::new(whole, tied.material), Limit::Stuck);
    assert_eq!(zero, 6);
    for (a, b) in of_tied.iter().zip(&of_whole).skip(6) {
        assert!((a / b - 1.0).abs() < 1e-9, "{a} {b}");
    }
}

/// Each free slip that strains nothing adds a zero mode; a joint law removes these modes while the joint is stuck.
#[test]
fn slips_are_counted() {
    let law: Law = Arc::new(Jenkins::new(50.0, 1.0).unwrap());
    for patch in [Patch::Rigid, Patch::Averaging] {
        let mut structure = two_blocks();
        structure.joints.push(
            Joint::new("joint", "right", "left", Interface::Whole(patch))
                .slip([0.0, 1.0, 1.0], Some(law.clone()))
                .slip([0.0, 1.0, -1.0], None),
        );
        assert_eq!(frequencies(&structure, Limit::Stuck).0, 7, "{patch:?}");
        assert_eq!(frequencies(&structure, Limit::Slipping).0, 8, "{patch:?}");
    }
}

/// A light block with a lump of mass and springs has the eigenvalues of these, and a support that holds two directions leaves one unknown
/// for each node.
#[test]
fn supports_and_lumps_do_what_they_say() {
    let lines = [uniform(0.0, 2.0, 4), uniform(0.0, 1.0, 1), uniform(0.0, 1.0, 1)];
    let mut mesh = block(&lines);
    let all: Vec<usize> = (0..mesh.positions.len()).collect();
    mesh.node_sets.insert("all".into(), all);
    let mut structure = Structure::new(mesh, Material::new(1e6, 0.0, 1e-6).unwrap());
    let lump = Lump { name: "sensor".into(), nodes: "all".into(), mass: 2.0, stiffness: [8.0, 18.0, 32.0] };
    structure.lumps.push(lump);
    let modes = structure.assemble().unwrap().modes(Limit::Stuck, 6).unwrap();
    let expected = [4.0, 9.0, 16.0];
    let found: Vec<f64> = (0..6).map(|i| modes.eigenvalue(i)).collect();
    for value in expected {
        assert!(found.iter().any(|f| (f / value - 1.0).abs() < 1e-5), "{value} in {found:?}");
    }
    let support = Support { name: "clamp".into(), nodes: "all".into(), fixed: [true, true, false] };
    structure.supports.push(support);
    assert_eq!(structure.assemble().unwrap().unknowns(), 20);
}

fn refusal(change: impl Fn(&mut Structure)) -> String {
    let mut structure = two_blocks();
    change(&mut structure);
    structure.assemble().unwrap_err().to_string()
}

#[test]
fn impossible_structures_are_refused_by_name() {
    let joint = |face: &str, patch: &str, interface| Joint::new("bolt", face, patch, interface);
    let whole = Interface::Whole(Patch::Averaging);
    let message = refusal(|s| s.joints.push(joint("rigth", "left", whole)));
    assert!(
        message.contains("joint `bolt`") && message.contains("`rigth`") && message.contains("right"),
        "{message}"
    );
    let message = refusal(|s| s.joints.push(joint("empty", "left", whole)));
    assert!(message.contains("no nodes"), "{message}");
    let message = refusal(|s| s.joints.push(joint("right", "line", whole)));
    assert!(message.contains("line or in a point"), "{message}");
    let message = refusal(|s| s.joints.push(joint("left", "left", whole)));
    assert!(message.contains("depend on itself"), "{message}");
    let message = refusal(|s| s.joints.push(joint("right", "end", Interface::NodeToNode)));
    assert!(message.contains("node 1000") && message.contains("bolt"), "{message}");
    let message = refusal(|s| {
        s.joints.push(joint("right", "left", whole));
        s.joints.push(Joint::new("second", "right", "left", Interface::NodeToNode));
    });
    assert!(message.contains("joint `bolt`") && message.contains("joint `second`"), "{message}");
    let message = refusal(|s| {
        s.joints.push(joint("right", "left", whole).slip([1.0, 0.0, 0.0], None).slip([1.0, 1.0, 0.0], None));
    });
    assert!(message.contains("slip directions"), "{message}");
    let message = refusal(|s| {
        s.mesh.positions.push([9.0; 3]);
        s.mesh.node_labels.push(4711);
    });
    assert!(message.contains("node 4711") && message.contains("no element"), "{message}");
    let message = refusal(|s| s.mesh.elements[3].nodes.swap(0, 1));
    assert!(message.contains("element 4 "), "{message}");
    let message = refusal(|s| s.materials.push(("steel".into(), s.material)));
    assert!(message.contains("`steel`"), "{message}");
}

/// All displacements distinguish 50 modes well; the displacements along z on the top face of the beam distinguish 47 (rank and condition as
/// tests/peers/beam.py prints them).
#[test]
fn the_modal_filter_reports_rank_and_condition() {
    let assembled = paper::structure(Configuration::A, 1).unwrap().assemble().unwrap();
    let modes = assembled.modes(Limit::Stuck, 50).unwrap();
    let nodes = &assembled.structure().mesh.positions;
    let all: Vec<usize> = (0..3 * nodes.len()).collect();
    let filter = assembled.modal_filter(&modes, &all).unwrap();
    assert_eq!(filter.rank(), 50);
    assert!((filter.condition() - 1.4).abs() < 0.1, "{}", filter.condition());
    let top: Vec<usize> = (0..1458).filter(|&i| nodes[i][2] == 0.25).map(|i| 3 * i + 2).collect();
    assert_eq!(assembled.modal_filter(&modes, &top).unwrap().rank(), 47);
    assert!(assembled.modal_filter(&modes, &[1_000_000]).is_err());
}

/// Two blocks that nothing joins have twelve rigid motions, six more than one structure has; a warning says so.
#[test]
fn parts_that_move_freely_are_told() {
    let warnings = NamedModes::new(&two_blocks(), 2).unwrap().warnings();
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    let start = "8 zero modes with all joints stuck, 6 are rigid motions: parts can move freely";
    assert!(warnings[0].starts_with(start), "{warnings:?}");
}

/// A block on springs: a factor on the springs gives a structure made with these springs, and multiplies the squares of the lowest
/// frequencies by about as much.
#[test]
fn springs_are_corrected_by_a_factor() {
    let made = |stiffness: f64| {
        let mesh = block(&[uniform(0.0, 1.0, 2), uniform(0.0, 1.0, 2), uniform(0.0, 1.0, 2)]);
        let all = (0..mesh.positions.len()).collect();
        let mut structure = Structure::new(mesh, Material::new(100.0, 0.3, 1.0).unwrap());
        structure.mesh.node_sets.insert("all".into(), all);
        let stiffness = [stiffness; 3];
        structure.lumps.push(Lump { name: "feet".into(), nodes: "all".into(), mass: 0.0, stiffness });
        structure.assemble().unwrap()
    };
    let (given, truth) = (made(3.0), made(1.21 * 3.0));
    let reduced = given.reduce(60, Basis::default()).unwrap();
    let adjustable = Adjustable::new(&reduced, &[Correction::Springs(0)]).unwrap();
    let adjusted = adjustable.at(&[], &[], &[1.21]).unwrap();
    let modes = truth.modes(Limit::Stuck, 6).unwrap();
    for mode in 0..3 {
        let (found, expected) = (adjusted.mode(mode).unwrap().omega_squared(), modes.eigenvalue(mode));
        // The modes of the unchanged structure cannot represent those of the changed one completely: frequencies are too high, by an error
        // of second order.
        assert!((0.0..2e-5).contains(&(found / expected - 1.0)), "{mode}: {found} {expected}");
        // Three translations of the mass 1; the block's own flexibility makes their stiffness a little smaller.
        assert!((found / (3.0 * 1.21) - 1.0).abs() < 0.02, "{mode}: {found}");
    }
    for missing in [Correction::Springs(1), Correction::Material(0)] {
        let message = Adjustable::new(&reduced, &[missing]).unwrap_err().to_string();
        assert!(message.contains(&format!("the structure has no part {missing:?}")), "{message}");
    }
    assert!(format!("{adjustable:?}").starts_with("Adjustable { eigenvalues: ["), "{adjustable:?}");
}

/// A factor of two on the modulus of one of two materials gives a structure made with it.
#[test]
fn one_of_several_materials_is_corrected_by_a_factor() {
    let made = |factor: f64| {
        let mut structure = two_blocks();
        structure.joints.push(Joint::new("tie", "right", "left", Interface::NodeToNode));
        let later =
            structure.mesh.elements.iter().filter(|e| e.label >= 100).map(|e| e.label).collect::<Vec<_>>();
        let index = |label: u64| structure.mesh.elements.iter().position(|e| e.label == label).unwrap();
        let elements: Vec<usize> = later.into_iter().map(index).collect();
        structure.mesh.element_sets.insert("second".into(), elements);
        structure.materials.push(("second".into(), Material::new(factor * 1000.0, 0.3, 1.0).unwrap()));
        structure.assemble().unwrap()
    };
    let (given, truth) = (made(1.0), made(1.1));
    let reduced = given.reduce(60, Basis::default()).unwrap();
    let adjustable = Adjustable::new(&reduced, &[Correction::Material(0)]).unwrap();
    let adjusted = adjustable.at(&[], &[], &[1.1]).unwrap();
    let modes = truth.modes(Limit::Stuck, 10).unwrap();
    for mode in 6..9 {
        let (found, expected) = (adjusted.mode(mode).unwrap().omega_squared(), modes.eigenvalue(mode));
        assert!((found / expected - 1.0).abs() < 1e-3, "{mode}: {found} {expected}");
    }
}

#[test]
fn what_is_refused_has_its_kind_in_the_catalogue() {
    let paper = || paper::structure(Configuration::A, 1).unwrap();
    let kind = |change: &dyn Fn(&mut Structure)| {
        let mut structure = two_blocks();
        change(&mut structure);
        structure.assemble().unwrap_err().kind()
    };
    assert_eq!(Material::new(-1.0, 0.3, 1.0).unwrap_err().kind(), Kind::Value);
    let tie = |face: &str| Joint::new("tie", face, "left", Interface::NodeToNode);
    assert_eq!(kind(&|s| s.joints.push(tie("nowhere"))), Kind::MissingSet);
    assert_eq!(kind(&|s| s.joints.push(tie("empty"))), Kind::Structure);
    assert_eq!(kind(&|s| s.mesh.elements[0].nodes.swap(0, 1)), Kind::Structure);
    let named = NamedModes::new(&paper(), 2).unwrap();
    assert_eq!(named.named("bending 9").unwrap_err().kind(), Kind::MissingMode);
    assert_eq!(named.slip_flexibility(Vec::new()).unwrap_err().kind(), Kind::Analysis);
    let stop = |_: f64| std::ops::ControlFlow::Break(());
    let stopped = NamedModes::observed(&paper(), 2, &stop).unwrap_err();
    assert_eq!((stopped.kind(), stopped), (Kind::Interrupted, Error::Interrupted));
    let law: Result<Jenkins, _> = Jenkins::new(-1.0, 1.0);
    assert_eq!(Error::from(law.unwrap_err()).kind(), Kind::Value);
}

/// A law has no text of its own: messages describe a slip by its direction, stiffness and strength.
#[test]
fn a_slip_is_told_by_what_its_law_holds() {
    let law: Law = Arc::new(Jenkins::new(50.0, 1.5).unwrap());
    let joint = Joint::new("bolt", "right", "left", Interface::NodeToNode).slip([0.0, 1.0, 0.0], Some(law));
    let slip: &Slip = &joint.slips[0];
    assert_eq!(format!("{slip:?}"), "Slip { direction: [0.0, 1.0, 0.0], k_t, f_s: Some((50.0, 1.5)) }");
}
