//! Forced responses of one mode: the balance itself, the linear limit, force and response control against each other.

#![allow(clippy::unwrap_used, reason = "a failed test may panic and say why")]

use std::f64::consts::{PI, TAU};

use iwan_core::{Backbone, FourParameter};
use iwan_sim::{Control, JointLaw, Mode, SteadyCurve, SteadyPoint, Sweep, forced_response};

fn mode_1() -> Mode {
    let joint = FourParameter::new(4.45e4, 239.4, -0.183, 0.3).unwrap();
    let mut mode = Mode::new("bending 1", 124.0, Some(JointLaw::FourParameter(joint)));
    mode.damping_ratio = 2.5e-4;
    mode
}

fn sweep(control: Control, levels: &[f64]) -> Sweep {
    Sweep { from: 112.0, to: 128.0, control, levels: levels.to_vec(), harmonics: 1, points: 400 }
}

/// a |K_∞ + K_1 - ω² + i (c ω + D/πa²)| over the excitation's modal force, and the phase, from the laws' closed forms.
fn balance(mode: &Mode, point: &SteadyPoint) -> (f64, f64) {
    let oscillator = mode.oscillator().unwrap();
    let (a, omega) = (point.amplitude, TAU * point.frequency);
    let (k, d) =
        mode.joint.as_ref().map_or((0.0, 0.0), |law| (law.harmonic_stiffness(a), law.dissipation(a)));
    let re = oscillator.k_inf() + k - omega * omega;
    let im = oscillator.viscous() * omega + d / (PI * a * a);
    (a * re.hypot(im), -im.atan2(re))
}

fn largest_gap(curve: &SteadyCurve) -> f64 {
    let log: Vec<f64> = curve.points.iter().map(|p| p.amplitude.ln()).collect();
    log.windows(2).map(|w| (w[1] - w[0]).abs()).fold(0.0, f64::max)
}

#[test]
fn every_point_is_balanced() {
    let mut mode = mode_1();
    mode.shape_at_force = 23.5;
    // The largest force brings the mode into macro-slip.
    let curves = forced_response(&mode, &sweep(Control::Force, &[1e-3, 0.3, 3.0, 10.0, 14.0]), 1.0).unwrap();
    for curve in &curves {
        assert!(
            curve.remarks.is_empty() && curve.points.len() > 300,
            "{} {:?}",
            curve.points.len(),
            curve.remarks
        );
        assert!(largest_gap(curve) < 0.3, "{}", largest_gap(curve));
        for point in &curve.points {
            let (force, phase) = balance(&mode, point);
            assert!((force / (23.5 * curve.level) - 1.0).abs() < 1e-8, "{point:?} {force}");
            assert!((point.phase - phase).abs() < 1e-8, "{point:?} {phase}");
            assert!((112.0..=128.0).contains(&point.frequency) && point.excitation == curve.level);
        }
        // It reaches both ends of the band.
        let ends = [curve.points[0].frequency, curve.points.last().unwrap().frequency];
        assert!((ends[0] - 112.0).abs() < 0.2 && (ends[1] - 128.0).abs() < 0.2, "{ends:?}");
    }
    let peaks: Vec<_> = curves.iter().map(|c| c.peak().unwrap().clone()).collect();
    assert!(peaks.windows(2).all(|w| w[0].frequency > w[1].frequency && w[0].amplitude < w[1].amplitude));
    assert!(peaks[4].amplitude > mode.joint.as_ref().unwrap().strengths().1);
}

#[test]
fn without_a_joint_it_is_the_linear_oscillator() {
    let mut mode = Mode::new("linear", 100.0, None);
    mode.damping_ratio = 0.02;
    let curve =
        &forced_response(&mode, &Sweep { from: 20.0, to: 300.0, ..sweep(Control::Force, &[2.0]) }, 1.0)
            .unwrap()[0];
    for point in &curve.points {
        let (force, phase) = balance(&mode, point);
        assert!((force / 2.0 - 1.0).abs() < 1e-12 && (point.phase - phase).abs() < 1e-12, "{point:?}");
    }
    // Peak of the displacement: ω0² (1 - 2ζ²), f/(2ζ ω0² √(1-ζ²)).
    let peak = curve.peak().unwrap();
    let exact = 2.0 / (0.04 * (TAU * 100.0).powi(2) * (1.0_f64 - 4e-4).sqrt());
    assert!((peak.amplitude / exact - 1.0).abs() < 1e-12, "{} {exact}", peak.amplitude);
    assert!((peak.frequency - 100.0 * (1.0_f64 - 8e-4).sqrt()).abs() < 1e-6, "{}", peak.frequency);
}

#[test]
fn held_responses_ask_for_the_force_that_makes_them() {
    let mut mode = mode_1();
    mode.shape_at_force = -3.0;
    for (control, level) in
        [(Control::Displacement, 2e-3), (Control::Velocity, 1.5), (Control::Acceleration, 1200.0)]
    {
        let curve = &forced_response(&mode, &sweep(control, &[level]), 2.0).unwrap()[0];
        assert!(curve.points.len() >= 380 && curve.remarks.is_empty(), "{control:?} {}", curve.points.len());
        for point in &curve.points {
            let omega = TAU * point.frequency;
            let held = match control {
                Control::Velocity => point.amplitude * omega,
                Control::Acceleration => point.amplitude * omega * omega,
                _ => point.amplitude,
            };
            assert!((held / level - 1.0).abs() < 1e-12, "{point:?}");
            let modal = SteadyPoint { amplitude: point.amplitude / 2.0, ..point.clone() };
            let (force, phase) = balance(&mode, &modal);
            assert!((3.0 * point.excitation / force - 1.0).abs() < 1e-12, "{point:?} {force}");
            // A negative shape turns the response round.
            assert!((point.phase - PI - phase).abs() < 1e-12, "{point:?} {phase}");
        }
        assert!(curve.jumps().is_empty());
    }
}

#[test]
fn a_base_pushes_against_its_acceleration() {
    let mode = mode_1();
    let force = forced_response(&mode, &sweep(Control::Force, &[3.0]), 1.0).unwrap();
    let base = forced_response(&mode, &sweep(Control::BaseAcceleration, &[3.0]), 1.0).unwrap();
    for (a, b) in force[0].points.iter().zip(&base[0].points) {
        assert!(a.amplitude == b.amplitude && (b.phase - a.phase - PI).abs() < 1e-12, "{a:?} {b:?}");
    }
}

#[test]
fn strong_softening_turns_the_curve_back() {
    // A joint that is most of the stiffness and loses little: an S in the curve.
    let joint = FourParameter::new(3.0e5, 300.0, -0.02, 0.0).unwrap();
    let mode = Mode::new("soft", 100.0, Some(JointLaw::FourParameter(joint)));
    let sweep = Sweep { from: 20.0, to: 150.0, ..sweep(Control::Force, &[1.0, 80.0]) };
    let curves = forced_response(&mode, &sweep, 1.0).unwrap();
    let turns: Vec<usize> = curves.iter().map(|curve| curve.jumps().len()).collect();
    assert_eq!(turns[0], 0, "{turns:?}");
    assert!(turns[1].is_multiple_of(2), "{turns:?}");
    for point in &curves[1].points {
        assert!((balance(&mode, point).0 / 80.0 - 1.0).abs() < 1e-8);
    }
}

#[test]
fn what_friction_cannot_hold_is_said() {
    let mut mode = mode_1();
    mode.damping_ratio = 0.0;
    let most = 4.0 * 239.4 / PI;
    let curves = forced_response(&mode, &sweep(Control::Force, &[0.99 * most, 1.01 * most]), 1.0).unwrap();
    assert!(curves[0].remarks.is_empty(), "{:?}", curves[0].remarks);
    assert!(curves[1].remarks[0].contains("grows without bound"), "{:?}", curves[1].remarks);
    assert!(curves[1].points.len() > 20);
}

#[test]
fn bad_input_is_named() {
    let mode = mode_1();
    let refused = |sweep: Sweep| forced_response(&mode, &sweep, 1.0).unwrap_err().to_string();
    assert!(refused(sweep(Control::Force, &[0.0])).contains("level = 0"));
    assert!(refused(sweep(Control::Force, &[f64::NAN])).contains("level = NaN"));
    assert!(refused(sweep(Control::Force, &[])).contains("levels"));
    assert!(refused(Sweep { from: 0.0, ..sweep(Control::Force, &[1.0]) }).contains("from = 0"));
    assert!(refused(Sweep { to: 112.0, ..sweep(Control::Force, &[1.0]) }).contains("to = 112"));
    assert!(refused(Sweep { harmonics: 2, ..sweep(Control::Force, &[1.0]) }).contains("harmonics = 2"));
    assert!(forced_response(&mode, &sweep(Control::Force, &[1.0]), 0.0).is_err());
    let off = forced_response(&mode, &Sweep { from: 10.0, to: 20.0, ..sweep(Control::Force, &[1.0]) }, 1.0)
        .unwrap();
    assert!(off[0].remarks[0].contains("no resonance"), "{:?}", off[0].remarks);
    assert!(off[0].points.len() > 100);
}
