//! Hexahedra, tetrahedra and wedges against CalculiX: numbers and their origin in tests/peers of the project.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use crate::solids::{cut, with_middles};
use iwan_fem::mesh::block::{block, uniform};
use iwan_fem::mesh::{Mesh, Shape};
use iwan_fem::{Formulation, Limit, Material, Structure, Support};

/// Relative tolerance of frequencies: CalculiX prints seven digits.
const DIGITS: f64 = 1e-6;

/// Frequencies, Hz, by body and element.
fn stored(text: &str) -> BTreeMap<(String, String), Vec<f64>> {
    let mut cases: BTreeMap<(String, String), Vec<f64>> = BTreeMap::new();
    for line in text.lines().filter(|line| !line.starts_with('#')).skip(1) {
        let fields: Vec<&str> = line.split(',').collect();
        let frequency = fields[3].parse().expect("a frequency");
        cases.entry((fields[0].into(), fields[1].into())).or_default().push(frequency);
    }
    cases
}

/// The function `skew` of the script.
fn skew([x, y, z]: [f64; 3]) -> [f64; 3] {
    let bump = (PI * x / 6.0).sin() * (PI * y / 3.0).sin() * (PI * z / 2.0).sin();
    [x + 0.2 * bump, y - 0.15 * bump, z + 0.1 * bump]
}

/// The mesh of a body, and the x coordinate of its clamped end.
fn body(name: &str) -> (Mesh, Option<f64>) {
    let beam = block(&[uniform(-10.0, 10.0, 80), uniform(-1.0, 1.0, 8), uniform(0.0, 0.25, 1)]);
    match name {
        "beam" => (beam, None),
        "cantilever" => (beam, Some(-10.0)),
        _ => {
            let mut mesh = block(&[uniform(0.0, 6.0, 6), uniform(0.0, 3.0, 3), uniform(0.0, 2.0, 2)]);
            if name == "skewed" {
                mesh.positions.iter_mut().for_each(|position| *position = skew(*position));
            }
            (mesh, Some(0.0))
        }
    }
}

/// Elastic frequencies in Hz.
fn frequencies(name: &str, element: &str, count: usize) -> Vec<f64> {
    let (mut mesh, wall) = body(name);
    match element {
        "C3D4" | "C3D10" => cut(&mut mesh, Shape::Tet4),
        "C3D6" | "C3D15" => cut(&mut mesh, Shape::Wedge6),
        _ => {}
    }
    match element {
        "C3D20" => with_middles(&mut mesh, Shape::Hex20),
        "C3D10" => with_middles(&mut mesh, Shape::Tet10),
        "C3D15" => with_middles(&mut mesh, Shape::Wedge15),
        _ => {}
    }
    if name == "curved" {
        mesh.positions.iter_mut().for_each(|position| *position = skew(*position));
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

fn compare(text: &str, cases: usize) {
    let stored = stored(text);
    assert_eq!(stored.len(), cases);
    for ((name, element), expected) in stored {
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

#[test]
fn plain_hexahedra_have_the_frequencies_of_calculix() {
    compare(include_str!("../../../tests/peers/calculix.csv"), 6);
}

/// Bricks cut into tetrahedra and wedges, with straight and with curved edges.
#[test]
fn tetrahedra_and_wedges_have_the_frequencies_of_calculix() {
    compare(include_str!("../../../tests/peers/calculix_solids.csv"), 6);
}
