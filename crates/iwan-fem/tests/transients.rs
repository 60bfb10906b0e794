//! Transients of the paper's beam: full model, reduced model, an independent prototype.

use std::sync::OnceLock;

use iwan_core::Pulse;
use iwan_fem::mesh::beam::Configuration;
use iwan_fem::{Assembled, Basis, Class, Contact, Modes, Population, Transient, TruthResponse, paper};

struct Beam {
    assembled: Assembled,
    modes: Modes,
    bending: Vec<usize>,
}

fn beam() -> &'static Beam {
    static BEAM: OnceLock<Beam> = OnceLock::new();
    BEAM.get_or_init(|| {
        let assembled = paper::structure(Configuration::A, 1).unwrap().assemble().unwrap();
        let modes = assembled.modes(Contact::Stuck, 50).unwrap();
        let bending = (0..20).filter(|&i| assembled.classify(&modes, i) == Class::Bending).collect();
        Beam { assembled, modes, bending }
    })
}

/// The paper's blow at the tip, recorded in bending modes 1 to 3.
fn blow(amplitude: f64, steps: usize) -> Transient<'static> {
    let Beam { assembled, modes, bending } = beam();
    Transient {
        dt: 1e-5,
        steps,
        pulse: Pulse::Haversine { amplitude, duration: 1.6e-3 },
        load: assembled.load("tip", [0.0, 0.0, 1.0]).unwrap(),
        initial_velocity: None,
        population: Population::default(),
        outputs: (0..3)
            .map(|r| assembled.modal_output(format!("bending {}", r + 1), modes, bending[r]))
            .chain([assembled.output("tip", "tip", [0.0, 0.0, 1.0]).unwrap()])
            .collect(),
    }
}

fn peak(x: &[f64]) -> f64 {
    x.iter().fold(0.0_f64, |m, x| m.max(x.abs()))
}

/// Root mean square of the difference over that of the reference.
fn distance(x: &[f64], reference: &[f64]) -> f64 {
    let square = |x: &mut dyn Iterator<Item = f64>| x.map(|x| x * x).sum::<f64>();
    let difference = square(&mut x.iter().zip(reference).map(|(a, b)| a - b));
    (difference / square(&mut reference.iter().copied())).sqrt()
}

fn slip_ratio(response: &TruthResponse) -> f64 {
    response.slips.iter().fold(0.0_f64, |m, s| m.max(s.slip_ratio))
}

/// Section 5: peaks of |q''| of bending modes 1, 2, 3 and the largest slip, by the reduced model.
#[test]
fn peaks_are_those_of_the_prototype() {
    let reduced = beam().assembled.reduce(50, Basis::default()).unwrap();
    assert_eq!(reduced.coordinates(), 58);
    for (amplitude, peaks, slip, tolerance) in [
        (10.0, [220.78, 328.67, 337.47], 0.0289, 2e-3),
        (100.0, [2207.5, 3288.9, 3349.3], 0.300, 2e-3),
        (1000.0, [22060.0, 32878.0, 32870.0], 7.68, 1e-2),
    ] {
        let response = reduced.transient(&blow(amplitude, 20_000)).unwrap();
        for (history, expected) in response.outputs.iter().zip(peaks) {
            let found = peak(&history.acceleration);
            assert!(
                (found / expected - 1.0).abs() < tolerance,
                "{amplitude} {} {found} {expected}",
                history.name
            );
        }
        assert!((slip_ratio(&response) / slip - 1.0).abs() < 1e-2, "{}", slip_ratio(&response));
        assert!(response.energy.error() < 1e-12, "{}", response.energy.error());
    }
}

/// The reduced model against the full one, and what it costs to leave the attachment vectors out.
#[test]
fn reduced_agrees_with_full_and_only_with_attachment_vectors() {
    let steps = 2000;
    let reduced = beam().assembled.reduce(50, Basis::default()).unwrap();
    let without = beam().assembled.reduce(50, Basis::Modes).unwrap();
    for (amplitude, tolerance, without_attachments) in [(10.0, 1e-5, 1e-4), (1000.0, 5e-4, 0.1)] {
        let of = blow(amplitude, steps);
        let full = beam().assembled.transient(&of).unwrap();
        assert!(full.energy.error() < 1e-12, "{}", full.energy.error());
        let errors = |response: &TruthResponse| -> Vec<f64> {
            let pairs = response.outputs.iter().zip(&full.outputs);
            pairs.map(|(a, b)| distance(&a.acceleration, &b.acceleration)).collect()
        };
        let (with, bare) =
            (errors(&reduced.transient(&of).unwrap()), errors(&without.transient(&of).unwrap()));
        assert!(with[0] < tolerance, "{amplitude} {with:?}");
        assert!(bare[0] > without_attachments && bare[0] > 30.0 * with[0], "{amplitude} {bare:?}");
    }
}
