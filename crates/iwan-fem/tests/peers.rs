//! Plain hexahedra of 8 and of 20 nodes against CalculiX: numbers and their origin in tests/peers of the project.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use iwan_fem::mesh::block::{block, uniform};
use iwan_fem::mesh::{Mesh, Shape};
use iwan_fem::{Formulation, Limit, Material, Structure, Support};

/// CalculiX prints seven digits.
const DIGITS: f64 = 1e-6;

/// Frequencies by body and element.
fn stored() -> BTreeMap<(String, String), Vec<f64>> {
    let text = include_str!("../../../tests/peers/calculix.csv");
    let mut cases: BTreeMap<(String, String), Vec<f64>> = BTreeMap::new();
    for line in text.lines().filter(|line| !line.starts_with('#')).skip(1) {
        let fields: Vec<&str> = line.split(',').collect();
        let frequency = fields[3].parse().expect("a frequency");
        cases.entry((fields[0].into(), fields[1].into())).or_default().push(frequency);
    }
    cases
}

/// `skew` of the script.
fn skew([x, y, z]: [f64; 3]) -> [f64; 3] {
    let bump = (PI * x / 6.0).sin() * (PI * y / 3.0).sin() * (PI * z / 2.0).sin();
    [x + 0.2 * bump, y - 0.15 * bump, z + 0.1 * bump]
}

/// The body, and the x of its clamped end.
fn body(name: &str) -> (Mesh, Option<f64>) {
    let beam = block(&[uniform(-10.0, 10.0, 80), uniform(-1.0, 1.0, 8), uniform(0.0, 0.25, 1)]);
    match name {
        "beam" => (beam, None),
        "cantilever" => (beam, Some(-10.0)),
        _ => {
            let mut mesh = block(&[uniform(0.0, 6.0, 6), uniform(0.0, 3.0, 3), uniform(0.0, 2.0, 2)]);
            for position in &mut mesh.positions {
                *position = skew(*position);
            }
            (mesh, Some(0.0))
        }
    }
}

/// Nodes in the middle of straight edges.
fn with_middles(mesh: &mut Mesh) {
    let mut middles: BTreeMap<(usize, usize), usize> = BTreeMap::new();
    for element in &mut mesh.elements {
        for (a, b) in Shape::Hex20.edges() {
            let (a, b) = (element.nodes[*a], element.nodes[*b]);
            let node = *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                let (p, q) = (mesh.positions[a], mesh.positions[b]);
                mesh.positions.push(std::array::from_fn(|i| 0.5 * (p[i] + q[i])));
                mesh.node_labels.push(mesh.positions.len() as u64);
                mesh.positions.len() - 1
            });
            element.nodes.push(node);
        }
        element.shape = Shape::Hex20;
    }
}

/// Elastic frequencies in Hz.
fn frequencies(name: &str, element: &str, count: usize) -> Vec<f64> {
    let (mut mesh, wall) = body(name);
    if element == "C3D20" {
        with_middles(&mut mesh);
    }
    let clamped: Vec<usize> =
        (0..mesh.positions.len()).filter(|n| Some(mesh.positions[*n][0]) == wall).collect();
    mesh.node_sets.insert("clamp".into(), clamped);
    let steel = Material::new(28.0e6, 0.29, 7.48e-4).expect("steel");
    let mut structure = Structure::new(mesh, steel);
    structure.formulation = Formulation::Displacement;
    if wall.is_some() {
        structure.supports.push(Support { name: "wall".into(), nodes: "clamp".into(), fixed: [true; 3] });
    }
    assert_eq!(structure.check().message(), None);
    let zero = if wall.is_some() { 0 } else { 6 };
    let modes = structure.assemble().and_then(|a| a.modes(Limit::Stuck, count + zero)).expect("modes");
    assert_eq!(modes.zero_modes(), zero, "{name} {element}");
    modes.frequencies()[zero..].to_vec()
}

#[test]
fn plain_elements_have_the_frequencies_of_calculix() {
    let cases = stored();
    assert_eq!(cases.len(), 6);
    for ((name, element), expected) in cases {
        let found = frequencies(&name, &element, expected.len());
        for (mode, (found, expected)) in found.iter().zip(&expected).enumerate() {
            let error = (found / expected - 1.0).abs();
            assert!(
                error < DIGITS,
                "{name} {element} mode {}: {found} against {expected} ({error:.1e})",
                mode + 1
            );
        }
    }
}
