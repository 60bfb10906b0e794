//! Curves of an adjusted reduced structure against curves of the full structure, and their derivatives against differences.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use std::f64::consts::TAU;
use std::sync::Arc;

use iwan_core::{Backbone, FourParameter, Pulse};
use iwan_fem::mesh::beam::Configuration;
use iwan_fem::{
    Adjustable, Basis, Blow, Correction, Kinematic, Law, Limit, Material, Output, Representation, Stiffness,
    Structure, Transient, paper,
};

/// Slips of the built-in beam: links and washers, each in x and y.
const LINKS: [usize; 4] = [0, 1, 2, 3];
const WASHERS: [usize; 4] = [4, 5, 6, 7];
/// Index of the first bending mode, after six rigid motions.
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

/// The reduced structure with other joints agrees with a structure made with these joints: secant frequency and dissipation from micro-slip
/// to macro-slip.
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

/// Another Young's modulus, and the original one again; the first harmonic follows from the virgin curve by Masing's rule.
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
    // Where the modal force is a power law, its harmonic stiffness follows from the power, which the secant stiffnesses at q/2 and q give.
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

/// Derivatives of frequency and dissipation agree to 1e-7 with central differences, from micro-slip to macro-slip.
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
            // Differences of fourth order are used: those of second order would have errors as large as the tolerance.
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

/// Slips without a group keep the laws of the structure: the curve is that of groups with these laws. An adjustment without any unknown
/// parameter once led to a panic.
#[test]
fn slips_without_a_group_keep_their_own_laws() {
    let table_1 = paper::joint().unwrap();
    let given = beam(table_1, 28.0e6).assemble().unwrap();
    let reduced = given.reduce(20, Basis::default()).unwrap();
    let adjustable = Adjustable::new(&reduced, &[]).unwrap();
    let (own, grouped) =
        (adjustable.at(&[], &[], &[]).unwrap(), adjustable.at(&groups(), &[table_1; 2], &[]).unwrap());
    let q = [1e-4, 1e-3, 6e-3];
    for stiffness in [Stiffness::FirstHarmonic, Stiffness::Secant] {
        let curves = [&own, &grouped].map(|a| a.mode(BENDING).unwrap().curve(a, &q, stiffness).unwrap());
        for (a, b) in curves[0].iter().zip(&curves[1]) {
            assert!((a.omega_squared / b.omega_squared - 1.0).abs() < 1e-10, "{a:?} {b:?}");
            assert!((a.dissipation / b.dissipation - 1.0).abs() < 1e-7, "{a:?} {b:?}");
        }
    }
    // The participation of a slip in a stuck mode is the entry of the mode's shape, and rigid motions do not slip.
    let (slip, modes) = (&given.slips()[0], reduced.modes());
    assert_eq!(adjustable.participation(0, BENDING), modes.shape(BENDING)[slip.unknown]);
    assert_eq!(adjustable.participation(0, 2), 0.0);
    assert_eq!(adjustable.slips()[0], slip.name);
    let message = own.mode(2).unwrap_err().to_string();
    assert!(message.contains("mode 2 is not an elastic mode of the reduced model"), "{message}");
}

/// The response to a blow, from modes that joints couple, agrees with that of the reduced model by its own stepper: from micro-slip to
/// macro-slip, rigid motions included.
#[test]
fn a_blow_is_that_of_the_reduced_model() {
    let assembled = paper::structure(Configuration::A, 1).unwrap().assemble().unwrap();
    let reduced = assembled.reduce(12, Basis::default()).unwrap();
    let adjustable = Adjustable::new(&reduced, &[]).unwrap();
    let tip = assembled.load("tip", [0.0, 0.0, 1.0]).unwrap();
    let load = adjustable.in_coordinates(&reduced, &tip).unwrap();
    let (step, samples) = (2.5e-6, 2001);
    for amplitude in [10.0, 1000.0] {
        let pulse = Pulse::Haversine { amplitude, duration: 1.6e-3 };
        let force: Vec<f64> = (0..samples).map(|n| pulse.at(step * n as f64)).collect();
        let task = Transient {
            dt: step,
            steps: samples - 1,
            pulse,
            load: tip.clone(),
            initial_velocity: None,
            representation: Representation::DEFAULT_IN_A_STRUCTURE,
            outputs: vec![Output { name: "tip".into(), coefficients: tip.clone() }],
        };
        let expected = reduced.transient(&task).unwrap();
        let blow = Blow {
            step,
            force: &force,
            load: &load,
            outputs: std::slice::from_ref(&load),
            kinematic: Kinematic::Displacement,
            every: 1,
            samples,
            bins: 100,
        };
        let adjusted = adjustable.at(&[], &[], &[]).unwrap();
        let own = &expected.outputs[0];
        for (kinematic, history, tolerance) in [
            (Kinematic::Displacement, &own.displacement, 2e-4),
            (Kinematic::Velocity, &own.velocity, 2e-3),
            (Kinematic::Acceleration, &own.acceleration, 2e-2),
        ] {
            let struck = adjusted.struck(&Blow { kinematic, ..blow }, |_| 0.0).unwrap();
            let peak = history.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            let off =
                struck.motion[0].iter().zip(history).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
            assert!(
                struck.motion[0].len() == samples && off < tolerance * peak,
                "{kinematic:?} {off} {peak}"
            );
            // A response with fewer samples holds some of these samples.
            let fewer = Blow { kinematic, every: 8, samples: 251, ..blow };
            let fewer = adjusted.struck(&fewer, |_| 0.0).unwrap();
            assert!(fewer.motion[0].iter().eq(struck.motion[0].iter().step_by(8)));
            let most = |slip: &[f64]| slip.iter().fold(0.0_f64, |most, s| most.max(s.abs()));
            let largest = expected.slips.iter().map(|s| most(&s.slip)).fold(0.0, f64::max);
            for (found, slip) in struck.slips.iter().zip(&expected.slips) {
                assert!((found - most(&slip.slip)).abs() < 5e-3 * largest, "{} {found}", slip.name);
            }
        }
    }
}

/// Damping takes energy out, and a model that cannot be stepped is refused with a remedy.
#[test]
fn blows_on_an_adjusted_structure_are_damped_and_checked() {
    let assembled = paper::structure(Configuration::A, 1).unwrap().assemble().unwrap();
    let reduced = assembled.reduce(12, Basis::default()).unwrap();
    let adjustable = Adjustable::new(&reduced, &[]).unwrap();
    let tip = assembled.load("tip", [0.0, 0.0, 1.0]).unwrap();
    let load = adjustable.in_coordinates(&reduced, &tip).unwrap();
    let force = [1.0; 20];
    let blow = Blow {
        step: 1e-5,
        force: &force,
        load: &load,
        outputs: std::slice::from_ref(&load),
        kinematic: Kinematic::Acceleration,
        every: 1,
        samples: 4000,
        bins: 50,
    };
    let adjusted = adjustable.at(&[], &[], &[]).unwrap();
    let last = |ratio: f64| {
        let struck = adjusted.struck(&blow, |_| ratio).unwrap();
        struck.motion[0][3000..].iter().map(|a| a * a).sum::<f64>()
    };
    // The energy of bending 1 alone decays by exp(-2 ζ ω t): to 0.19 at 35 ms for 3 % at 132 Hz. All other modes decay faster.
    assert!(last(0.03) < 0.19 * last(0.0), "{} {}", last(0.03), last(0.0));
    let refused = |blow: &Blow<'_>, ratio: f64| adjusted.struck(blow, |_| ratio).unwrap_err().to_string();
    let grows = refused(&Blow { force: &[f64::MAX; 20], ..blow }, 0.0);
    assert!(
        grows.starts_with("blow on an adjusted structure: ") && grows.contains("softer blows"),
        "{grows}"
    );
    for message in [
        refused(&Blow { step: 0.0, ..blow }, 0.0),
        refused(&blow, -1.0),
        refused(&Blow { bins: 0, ..blow }, 0.0),
    ] {
        assert!(message.starts_with("blow on an adjusted structure: "), "{message}");
    }
    let message = adjustable.in_coordinates(&reduced, &tip[1..]).unwrap_err().to_string();
    assert!(message.contains(&format!("a load or output has {} coefficients", tip.len() - 1)), "{message}");
}
