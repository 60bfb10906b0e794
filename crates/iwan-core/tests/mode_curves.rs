//! Modes known by their curves: the interpolation, and the ring-down of the mode from which the curves were made.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a failed test may panic and say why")]

use std::f64::consts::PI;

use iwan_core::{
    AveragedCurves, Continuum, CurveNewmark, CurvePoint, FourParameter, ModalLaw, ModeCurves, Motion,
    Newmark, Oscillator, ResidualStiffness, Reversal,
};

use crate::common::{Buffers, worst};

type Curves = ModeCurves<Vec<CurvePoint>>;

fn curves(amplitude: &[f64], frequency: &[f64], damping_ratio: &[f64]) -> Result<Curves, iwan_core::Error> {
    ModeCurves::new(amplitude, frequency, damping_ratio, vec![CurvePoint::default(); amplitude.len()])
}

/// The numbers are those of SciPy's `PchipInterpolator` in ln a (`tests/peers/pendulum.py`).
#[test]
fn the_cubics_are_those_of_pchip() {
    let amplitude = [1e-4, 3e-4, 1e-3, 5e-3, 1e-2];
    let found = curves(&amplitude, &[124.0, 123.9, 123.2, 122.9, 121.0], &[0.01; 5]).unwrap();
    let golden = [
        (1.5e-4, 123.983888550547),
        (5e-4, 123.638654178329),
        (2e-3, 123.083056785845),
        (7e-3, 122.251369167976),
    ];
    for (a, frequency) in golden {
        assert!((found.at(a).omega / (2.0 * PI) - frequency).abs() < 1e-10, "{a}");
        assert!((found.at(a).damping_ratio - 0.01).abs() < 1e-16);
    }
    // Beyond the points the curves are constant, and they are continuous at the ends.
    assert_eq!(found.at(1e-9), found.at(0.0));
    assert_eq!(found.at(1.0), found.at(1e9));
    assert!((found.at(1e-4).omega - found.at(0.0).omega).abs() < 1e-12);
    let (smallest, largest) = found.range();
    assert!((smallest / 1e-4 - 1.0).abs() < 1e-14 && (largest / 1e-2 - 1.0).abs() < 1e-14);
}

/// Between two points the curve stays between their values, whatever the points.
#[test]
fn no_extremes_between_the_points() {
    let mut random = iwan_core::SplitMix64::new(7);
    for _ in 0..200 {
        let amplitude: Vec<f64> = (0..12).map(|i| 10.0_f64.powf(-4.0 + 0.3 * f64::from(i))).collect();
        let zeta: Vec<f64> = (0..12).map(|_| 0.01 * (1.0 + random.next_symmetric())).collect();
        let found = curves(&amplitude, &[100.0; 12], &zeta).unwrap();
        for (i, pair) in amplitude.windows(2).enumerate() {
            let (low, high) = (zeta[i].min(zeta[i + 1]), zeta[i].max(zeta[i + 1]));
            for n in 0..=20 {
                let a = pair[0] * (pair[1] / pair[0]).powf(f64::from(n) / 20.0);
                let found = found.at(a).damping_ratio;
                assert!(found >= low - 1e-16 && found <= high + 1e-16, "{found} {low} {high}");
            }
        }
    }
}

#[test]
fn points_out_of_order_or_range_are_named() {
    let said = |a: &[f64], f: &[f64], z: &[f64]| curves(a, f, z).unwrap_err().to_string();
    assert!(said(&[1.0], &[1.0], &[0.0]).contains("amplitude has 1 entries, 2 are needed"));
    assert!(said(&[1.0, 2.0], &[1.0], &[0.0, 0.0]).contains("frequency has 1"));
    assert!(said(&[1.0, 1.0], &[1.0, 1.0], &[0.0, 0.0]).contains("amplitude[1] = 1"));
    assert!(said(&[0.0, 1.0], &[1.0, 1.0], &[0.0, 0.0]).contains("amplitude[0] = 0"));
    assert!(said(&[1.0, 2.0], &[1.0, -1.0], &[0.0, 0.0]).contains("frequency[1] = -1"));
    assert!(said(&[1.0, 2.0], &[1.0, f64::NAN], &[0.0, 0.0]).contains("frequency[1] = NaN"));
    assert!(said(&[1.0, 2.0], &[1.0, 1.0], &[0.0, 1.0]).contains("damping_ratio[1] = 1"));
    assert!(said(&[1.0, 2.0], &[1.0, 0.7], &[0.0, 0.0]).contains("less than a third"));
}

fn joint() -> FourParameter {
    FourParameter::new(4.45e4, 239.4, -0.183, 0.3).unwrap()
}

fn oscillator() -> Oscillator {
    Oscillator::new(124.0, 2.5e-4, 4.45e4, ResidualStiffness::Positive).unwrap()
}

/// 40 points of an Iwan mode's own curves, from 1e-4 to 1 φ_max.
fn of_an_iwan_mode() -> Curves {
    let joint = joint();
    let law = ModalLaw::new(oscillator(), Some(&joint), &[]);
    let amplitude: Vec<f64> =
        (0..40).map(|i| joint.phi_max() * 10.0_f64.powf(-4.0 + 4.0 * f64::from(i) / 39.0)).collect();
    let frequency: Vec<f64> = amplitude.iter().map(|a| law.frequency(*a) / (2.0 * PI)).collect();
    let damping: Vec<f64> = amplitude.iter().map(|a| law.damping_ratio(*a)).collect();
    curves(&amplitude, &frequency, &damping).unwrap()
}

/// Curves of an Iwan mode reproduce its ring-down over 50 cycles, to first order in the damping. After a release at 0.05 and 0.5 φ_max the
/// displacement is off by 2.4e-4 and 3.0e-3 of the released displacement, the amplitude by 0.03 and 0.4 %.
#[test]
fn curves_of_an_iwan_mode_reproduce_its_ring_down() {
    let (joint, mode, by_curves) = (joint(), oscillator(), of_an_iwan_mode());
    let (dt, samples) = (1e-5, 40_001);
    for (share, displacement_error, amplitude_error) in [(0.05, 5e-4, 6e-4), (0.5, 6e-3, 8e-3)] {
        let start = Motion::held_at(share * joint.phi_max());
        let law = Continuum::new(joint);
        let mut state = law.virgin(vec![Reversal::default(); 256]).unwrap();
        // The joint is first brought onto its outer loop: a virgin joint that is released is not yet on a closed cycle.
        let mut truth = Buffers::new(samples);
        iwan_core::Hysteresis::advance(&law, &mut state, start.displacement);
        let scheme = Newmark::prewarped(dt, mode.omega0()).unwrap();
        scheme.integrate(&mode, &law, &mut state, 0.0, &[], &mut truth.samples()).unwrap();
        let mut found = Buffers::new(samples);
        let stepper = CurveNewmark::new(&by_curves, dt, true).unwrap();
        let end = stepper.integrate(start, &[], &mut found.samples()).unwrap();
        assert!(end.energy.error() < 1e-12, "{:?}", end.energy);
        let mut slow = Buffers::new(samples);
        AveragedCurves::new(&by_curves, start).unwrap().sample(dt, &mut slow.samples()).unwrap();
        let (against_truth, against_slow) = (worst(&found.0[0], &truth.0[0]), worst(&found.0[0], &slow.0[0]));
        println!("{share}: against the mode {against_truth}, against averaging {against_slow}");
        let amplitude = |out: &Buffers, n: usize| by_curves.amplitude(out.0[0][n], out.0[1][n]);
        let envelope =
            (0..samples).step_by(100).map(|n| (amplitude(&found, n) / amplitude(&truth, n) - 1.0).abs());
        let envelope = envelope.fold(0.0, f64::max);
        println!("envelope {envelope}");
        assert!(against_truth < displacement_error && envelope < amplitude_error, "{share}");
        assert!(against_slow < 3.0 * displacement_error, "{share}");
    }
}

/// With constant curves the stepper reproduces the linear mode under a force.
#[test]
fn constant_curves_are_a_linear_mode() {
    let linear = Oscillator::new(100.0, 0.02, 0.0, ResidualStiffness::Positive).unwrap();
    let same = curves(&[1e-6, 1e-2], &[100.0; 2], &[0.02; 2]).unwrap();
    let force = [10.0, 70.0, 90.0, -20.0];
    let (mut plain, mut found) = (Buffers::new(2001), Buffers::new(2001));
    let scheme = Newmark::prewarped(1e-4, linear.omega0()).unwrap();
    scheme.integrate(&linear, &iwan_core::NoJoint, &mut 0.0, 1.0, &force, &mut plain.samples()).unwrap();
    let start = Motion { displacement: 0.0, velocity: 1.0 };
    let end =
        CurveNewmark::new(&same, 1e-4, true).unwrap().integrate(start, &force, &mut found.samples()).unwrap();
    assert!(end.energy.error() < 1e-13);
    for k in 0..3 {
        assert!(worst(&found.0[k], &plain.0[k]) < 1e-11, "{k}");
    }
    assert!(CurveNewmark::new(&same, 6e-3, true).is_err());
}

/// Half the step gives a quarter of the error, under a force and in the decay after it.
#[test]
fn the_stepper_is_of_second_order() {
    let by_curves = of_an_iwan_mode();
    let end = |steps: usize| {
        let dt = 1e-4 / steps as f64;
        let blow = |n: usize| 300.0 * (1.0 - (2.0 * PI * n as f64 * dt / 1.6e-3).cos());
        let force: Vec<f64> = (0..=16 * steps).map(blow).collect();
        let mut out = Buffers::new(1000 * steps + 1);
        let stepper = CurveNewmark::new(&by_curves, dt, true).unwrap();
        stepper.integrate(Motion::default(), &force, &mut out.samples()).unwrap();
        out.0[0].iter().step_by(steps).copied().collect::<Vec<_>>()
    };
    let (a, b, c) = (end(4), end(8), end(16));
    let ratio = worst(&a, &b) / worst(&b, &c);
    assert!((ratio - 4.0).abs() < 0.4, "{ratio}");
}
