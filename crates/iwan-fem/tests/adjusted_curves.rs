//! Curves of an adjusted reduced structure, against the structure itself and their derivatives against differences.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use std::f64::consts::TAU;
use std::sync::Arc;

use iwan_core::{Backbone, FourParameter};
use iwan_fem::mesh::beam::Configuration;
use iwan_fem::{Adjustable, Basis, Correction, Law, Limit, Material, Stiffness, Structure, paper};

/// Slips of the built-in beam: links and washers, each in x and y.
const LINKS: [usize; 4] = [0, 1, 2, 3];
const WASHERS: [usize; 4] = [4, 5, 6, 7];
/// First bending mode behind six rigid motions.
const BENDING: usize = 6;

fn beam(links: FourParameter, young: f64) -> Structure {
    let mut structure = paper::structure(Configuration::A, 1).unwrap();
    let law: Law = Arc::new(links);
    for joint in structure.joints.iter_mut().filter(|joint| joint.name.contains("link")) {
        joint.slips.iter_mut().for_each(|slip| slip.law = Some(law.clone()));
    }
    structure.material = Material::new(young, 0.29, 7.48e-4).unwrap();
    structure
}

fn groups() -> Vec<Vec<usize>> {
    vec![LINKS.to_vec(), WASHERS.to_vec()]
}

#[test]
fn slips_stand_in_the_order_taken_for_granted() {
    let assembled = paper::structure(Configuration::A, 1).unwrap().assemble().unwrap();
    let names: Vec<&str> = assembled.slips().iter().map(|slip| slip.name.as_str()).collect();
    assert!(LINKS.iter().all(|i| names[*i].contains("link")), "{names:?}");
    assert!(WASHERS.iter().all(|i| names[*i].contains("washer")), "{names:?}");
}

/// The reduced structure with other joints is the structure with other joints: secant frequency and dissipation from micro-slip to
/// macro-slip.
#[test]
fn other_joints_as_in_a_structure_made_with_them() {
    let table_1 = paper::joint().unwrap();
    let given = beam(table_1, 28.0e6).assemble().unwrap();
    let adjustable = Adjustable::new(&given.reduce(40, Basis::default()).unwrap(), &[]).unwrap();
    let other = FourParameter::new(2.0e5, 200.0, -0.5, 0.3).unwrap();
    let adjusted = adjustable.at(&groups(), &[other, table_1], &[]).unwrap();
    let truth = beam(other, 28.0e6).assemble().unwrap();
    let stuck = truth.modes(Limit::Stuck, 8).unwrap();
    let mode = adjusted.mode(BENDING).unwrap();
    let frequency = mode.omega_squared().sqrt() / TAU;
    assert!((frequency / stuck.frequency(BENDING) - 1.0).abs() < 1e-6, "{frequency}");
    let q = [1e-4, 1e-3, 6e-3, 2e-2];
    let expected = truth.quasi_static(&stuck, BENDING, 6.4e5).unwrap().curves(&q).unwrap();
    let found = mode.curve(&adjusted, &q, Stiffness::Secant).unwrap();
    for (i, point) in found.iter().enumerate() {
        let loss = stuck.frequency(BENDING) - expected.frequency[i];
        let own_loss = frequency - point.omega_squared.sqrt() / TAU;
        assert!((own_loss / loss - 1.0).abs() < 1e-3, "{i}: {own_loss} {loss}");
        assert!((point.dissipation / expected.dissipation[i] - 1.0).abs() < 2e-3, "{i}");
    }
}

/// Another Young's modulus, and back: the first harmonic of the virgin curve by Masing's rule.
#[test]
fn another_material_and_the_first_harmonic() {
    let table_1 = paper::joint().unwrap();
    let given = beam(table_1, 28.0e6).assemble().unwrap();
    let reduced = given.reduce(40, Basis::default()).unwrap();
    let adjustable = Adjustable::new(&reduced, &[Correction::GeneralMaterial]).unwrap();
    let adjusted = adjustable.at(&groups(), &[table_1; 2], &[1.03]).unwrap();
    let truth = beam(table_1, 1.03 * 28.0e6).assemble().unwrap().modes(Limit::Stuck, 8).unwrap();
    let mode = adjusted.mode(BENDING).unwrap();
    let change = mode.omega_squared() / truth.eigenvalue(BENDING) - 1.0;
    assert!(change.abs() < 1e-6, "{change}");
    // A power law of modal force has the harmonic stiffness of that power: between the curves of secants at q/2 and q.
    let q = [5e-4];
    let harmonic = mode.curve(&adjusted, &q, Stiffness::FirstHarmonic).unwrap()[0].omega_squared;
    let secant = |q: f64| mode.curve(&adjusted, &[q], Stiffness::Secant).unwrap()[0].omega_squared;
    let exponent = ((mode.omega_squared() - secant(5e-4)) / (mode.omega_squared() - secant(2.5e-4))).log2();
    let law = FourParameter::new(1.0, 1.0, exponent - 1.0, 0.0).unwrap();
    let softening = |k: f64| 1.0 - k;
    let u = 1e-2 * law.phi_max();
    let ratio = softening(law.harmonic_stiffness(u)) / softening(law.secant(u));
    let found = (mode.omega_squared() - harmonic) / (mode.omega_squared() - secant(5e-4));
    assert!((found / ratio - 1.0).abs() < 2e-3, "{found} {ratio}");
    assert!(adjustable.at(&groups(), &[table_1; 2], &[-1.0]).is_err());
    assert!(adjustable.at(&groups(), &[table_1], &[1.0]).is_err());
    assert!(adjustable.at(&[vec![0], vec![0]], &[table_1; 2], &[1.0]).is_err());
}

/// Derivatives of frequency and dissipation to 1e-7, from micro-slip to macro-slip, against central differences.
#[test]
fn derivatives_are_those_of_the_curves() {
    let given = beam(paper::joint().unwrap(), 28.0e6).assemble().unwrap();
    let reduced = given.reduce(30, Basis::default()).unwrap();
    let adjustable = Adjustable::new(&reduced, &[Correction::GeneralMaterial]).unwrap();
    let law = |p: &[f64]| FourParameter::new(p[0].exp(), p[1].exp(), p[2], p[3]).unwrap();
    let x = [12.4, 5.6, -0.35, 0.1, 12.7, 5.8, -0.2, 0.3, 0.02];
    let q = [2e-4, 2e-3, 8e-3];
    for stiffness in [Stiffness::FirstHarmonic, Stiffness::Secant] {
        let curve = |x: &[f64]| {
            let adjusted = adjustable.at(&groups(), &[law(&x[..4]), law(&x[4..8])], &[x[8].exp()]).unwrap();
            adjusted.mode(BENDING).unwrap().curve(&adjusted, &q, stiffness).unwrap()
        };
        let points = curve(&x);
        for j in 0..x.len() {
            let moved = |by: f64| {
                let mut x = x;
                x[j] += by;
                curve(&x)
            };
            // Differences of fourth order: those of second order are as far off as is allowed.
            let h = 1e-3;
            let at = [-2.0, -1.0, 1.0, 2.0].map(|n| moved(n * h));
            let slope = |of: &dyn Fn(usize) -> f64| (of(0) - 8.0 * of(1) + 8.0 * of(2) - of(3)) / (12.0 * h);
            for (i, point) in points.iter().enumerate() {
                let (w, d) = (slope(&|k| at[k][i].omega_squared), slope(&|k| at[k][i].dissipation));
                let loss = 1e-2 * point.omega_squared;
                assert!(
                    (point.omega_squared_by[j] - w).abs() < 1e-7 * loss.max(w.abs()),
                    "{j} {i} {w} {}",
                    point.omega_squared_by[j]
                );
                assert!(
                    (point.dissipation_by[j] - d).abs() < 1e-7 * point.dissipation.max(d.abs()),
                    "{j} {i} {d} {}",
                    point.dissipation_by[j]
                );
            }
        }
    }
}
