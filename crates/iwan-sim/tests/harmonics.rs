//! Harmonic balance with harmonics: its one-harmonic limit, time marching of the continuum, nonlinear modes.

#![allow(clippy::unwrap_used, reason = "a failed test may panic and say why")]

use std::f64::consts::{PI, TAU};

use iwan_core::{Backbone, Continuum, FourParameter, Hysteresis, Newmark, Reversal, Samples};
use iwan_sim::{
    Control, JointLaw, JointedModes, Mode, Residual, SlipJoint, SteadyPoint, StuckMode, Sweep, backbone,
    forced_response, forced_response_of, nonlinear_mode,
};

fn mode_1(damping_ratio: f64) -> Mode {
    let joint = FourParameter::new(4.45e4, 239.4, -0.183, 0.3).unwrap();
    Mode { damping_ratio, ..Mode::new("bending 1", 124.0, Some(JointLaw::FourParameter(joint))) }
}

/// A mode of the stiffness 6e5 of which `share` is its joint's.
fn soft_mode(share: f64) -> Mode {
    let joint = FourParameter::new(6e5 * share, 1e3 / 3.0 * share, -0.4, 0.1).unwrap();
    Mode { damping_ratio: 0.01, ..Mode::new("soft", 123.3, Some(JointLaw::FourParameter(joint))) }
}

fn sweep(control: Control, levels: &[f64], harmonics: usize) -> Sweep {
    Sweep { from: 112.0, to: 128.0, control, levels: levels.to_vec(), harmonics, points: 400 }
}

/// The modal force of a point by closed forms of one harmonic.
fn balance(mode: &Mode, point: &SteadyPoint) -> f64 {
    let oscillator = mode.oscillator().unwrap();
    let (a, omega) = (point.amplitude, TAU * point.frequency);
    let law = mode.joint.as_ref().unwrap();
    let re = oscillator.k_inf() + law.harmonic_stiffness(a) - omega * omega;
    let im = oscillator.viscous() * omega + law.dissipation(a) / (PI * a * a);
    a * re.hypot(im)
}

#[test]
fn with_one_harmonic_it_is_the_explicit_curve() {
    let mode = mode_1(2.5e-4);
    let jointed = JointedModes::of_mode(&mode, 1.0).unwrap();
    let one = sweep(Control::Force, &[0.1, 20.0, 150.0, 290.0], 1);
    let explicit = forced_response(&mode, &one, 1.0).unwrap();
    for (curve, explicit) in forced_response_of(&jointed, &one).unwrap().iter().zip(&explicit) {
        assert!(curve.remarks.is_empty(), "{:?}", curve.remarks);
        for point in &curve.points {
            assert!((balance(&mode, point) / curve.level - 1.0).abs() < 1e-8, "{point:?}");
        }
        let (peak, other) = (curve.peak().unwrap(), explicit.peak().unwrap());
        assert!((peak.amplitude / other.amplitude - 1.0).abs() < 1e-9, "{peak:?} {other:?}");
        assert!((peak.frequency / other.frequency - 1.0).abs() < 1e-6, "{peak:?} {other:?}");
        assert_eq!(curve.points.first().map(|p| p.frequency), Some(112.0));
        assert!(curve.points.last().is_some_and(|p| (p.frequency - 128.0).abs() < 1e-9));
    }
    for (control, level) in [(Control::Displacement, 5e-3), (Control::Acceleration, 3e3)] {
        let held = sweep(control, &[level], 1);
        let curve = &forced_response_of(&jointed, &held).unwrap()[0];
        assert!(curve.remarks.is_empty() && curve.points.len() > 10, "{:?}", curve.remarks);
        for point in &curve.points {
            let omega = TAU * point.frequency;
            let wanted = if control == Control::Displacement { level } else { level / (omega * omega) };
            assert!((point.amplitude / wanted - 1.0).abs() < 1e-9, "{point:?}");
            assert!((balance(&mode, point) / point.excitation - 1.0).abs() < 1e-8, "{point:?}");
        }
    }
}

/// Displacement of a steady motion at an angle of the excitation.
fn displacement(point: &SteadyPoint, theta: f64) -> f64 {
    let higher = point.harmonics.iter().enumerate();
    let first = point.amplitude * (theta + point.phase).cos();
    first + higher.map(|(i, [a, phase])| a * ((2 * i + 3) as f64 * theta + phase).cos()).sum::<f64>()
}

/// Cycles of the march: with a damping of 1 % and more, three quarters of any error of the start are gone after twenty.
const CYCLES: usize = 20;
/// Steps a cycle of the coarser of two marches.
const STEPS: usize = 20_000;

/// The last cycle of a march of the continuum in time that begins on a steady motion, at every `STEPS`th of a cycle.
fn marched(mode: &Mode, point: &SteadyPoint, steps: usize) -> Vec<f64> {
    const ROUND: usize = 400_000;
    let JointLaw::FourParameter(law) = mode.joint.clone().unwrap() else { unreachable!() };
    let joint = Continuum::new(law);
    let mut state = joint.virgin(vec![Reversal::default(); 256]).unwrap();
    let angle = |i: usize, of: usize| TAU * i as f64 / of as f64;
    for i in 0..=2 * ROUND {
        joint.advance(&mut state, displacement(point, angle(i, ROUND)));
    }
    let omega = TAU * point.frequency;
    let dt = TAU / omega / steps as f64;
    let h = 1e-5;
    let velocity = omega * (displacement(point, h) - displacement(point, -h)) / (2.0 * h);
    let force: Vec<f64> = (0..=CYCLES * steps).map(|i| point.excitation * angle(i, steps).cos()).collect();
    let mut out: [Vec<f64>; 4] = std::array::from_fn(|_| vec![0.0; force.len()]);
    let [q, v, a, f] = &mut out;
    let mut samples = Samples { displacement: q, velocity: v, acceleration: a, joint_force: f };
    let oscillator = mode.oscillator().unwrap();
    let scheme = Newmark::prewarped(dt, oscillator.omega0()).unwrap();
    scheme.integrate(&oscillator, &joint, &mut state, velocity, &force, &mut samples).unwrap();
    out[0][(CYCLES - 1) * steps..].iter().step_by(steps / STEPS).copied().collect()
}

/// How far the harmonics 1, 3 and 5 of a march's last cycle are from those of the steady motion it began on, over its amplitude;
/// two marches are extrapolated to a step of nothing. Were the motion not the steady one, the march would settle to
/// another. (In time the difference is that of the harmonics left out: beyond the 31st some 1e-7.)
fn drift(mode: &Mode, point: &SteadyPoint) -> f64 {
    let (coarse, fine) = (marched(mode, point, STEPS), marched(mode, point, 2 * STEPS));
    let limit: Vec<f64> = coarse.iter().zip(&fine).map(|(a, b)| (4.0 * b - a) / 3.0).collect();
    let mut worst = 0.0_f64;
    let own = [[point.amplitude, point.phase]];
    for (i, [amplitude, phase]) in own.iter().chain(&point.harmonics[..2]).enumerate() {
        let n = (2 * i + 1) as f64;
        let mut sums = [0.0; 2];
        for (step, q) in limit[..STEPS].iter().enumerate() {
            let angle = n * TAU * step as f64 / STEPS as f64;
            sums = [sums[0] + q * angle.cos(), sums[1] + q * angle.sin()];
        }
        let [re, im] = sums.map(|sum| 2.0 * sum / STEPS as f64);
        worst = worst.max((re - amplitude * phase.cos()).hypot(im + amplitude * phase.sin()));
    }
    worst / point.amplitude
}

/// What is left of the drift as harmonics are added: it falls, down to what the harmonics beyond the 31st do to the others.
fn falls(gaps: [f64; 3], last: f64) {
    assert!(gaps[0] > 3.0 * gaps[1] && gaps[1] > 3.0 * gaps[2] && gaps[2] < last, "{gaps:?}");
}

/// Within 1e-8 of the amplitude with 31 harmonics where the joint has a usual share of the mode's stiffness; a mode that hangs by its joint
/// is what harmonics tell slowest.
#[test]
fn time_marching_stays_on_the_steady_motion() {
    let cases = [
        ("micro", mode_1(0.01), 50.0, 1e-8),
        ("macro", mode_1(0.05), 800.0, 1e-8),
        ("macro", mode_1(0.05), 2000.0, 1e-8),
        ("micro", soft_mode(0.9), 60.0, 1e-8),
        ("macro", soft_mode(0.9), 330.0, 5e-7),
    ];
    for (slip, mode, level, last) in cases {
        let phi = mode.joint.as_ref().unwrap().strengths().1;
        let gaps = [7, 15, 31].map(|harmonics| {
            let band = Sweep { from: 20.0, to: 150.0, ..sweep(Control::Force, &[level], harmonics) };
            let curve = &forced_response(&mode, &band, 1.0).unwrap()[0];
            let peak = curve.peak().unwrap();
            assert_eq!(peak.amplitude > phi, slip == "macro", "{} {phi}", peak.amplitude);
            drift(&mode, peak)
        });
        falls(gaps, last);
    }
}

#[test]
fn a_superharmonic_resonance_is_found_and_marches() {
    let third = |point: &SteadyPoint| point.harmonics[0][0] / point.amplitude;
    for (mode, level, last) in [(soft_mode(0.3), 30.0, 1e-8), (soft_mode(0.9), 270.0, 1e-6)] {
        let gaps = [7, 15, 31].map(|harmonics| {
            let band = Sweep { from: 25.0, to: 60.0, ..sweep(Control::Force, &[level], harmonics) };
            let curve = &forced_response(&mode, &band, 1.0).unwrap()[0];
            let top = (1..curve.points.len() - 1).find(|&i| {
                let [before, here, after] = [i - 1, i, i + 1].map(|i| third(&curve.points[i]));
                here > before && here > after
            });
            let top = &curve.points[top.unwrap()];
            assert!(
                third(top) > 0.03 && (25.0..50.0).contains(&top.frequency),
                "{} {}",
                top.frequency,
                third(top)
            );
            drift(&mode, top)
        });
        falls(gaps, last);
    }
}

#[test]
fn a_force_that_nothing_holds_keeps_both_sides() {
    let mode = mode_1(0.0);
    let most = 4.0 * 239.4 / PI;
    let curve = &forced_response(&mode, &sweep(Control::Force, &[1.05 * most], 3), 1.0).unwrap()[0];
    let ends = [curve.points.first().unwrap().frequency, curve.points.last().unwrap().frequency];
    assert!((ends[0] - 112.0).abs() < 1e-9 && (ends[1] - 128.0).abs() < 1e-9, "{ends:?}");
    assert!(curve.remarks.iter().any(|r| r.contains("ends at")), "{:?}", curve.remarks);
}

#[test]
fn nonlinear_modes_of_one_mode() {
    for mode in [mode_1(2.5e-4), soft_mode(0.9)] {
        let phi = mode.joint.as_ref().unwrap().strengths().1;
        let amplitudes: Vec<f64> = (0..40).map(|i| phi * 1e-3 * 10.0_f64.powf(f64::from(i) / 9.75)).collect();
        let jointed = JointedModes::of_mode(&mode, 1.0).unwrap();
        let one = nonlinear_mode(&jointed, 0, 1, &amplitudes).unwrap();
        let seven = backbone(&mode, 7, &amplitudes).unwrap();
        assert!(one.remarks.is_empty() && seven.remarks.is_empty());
        for (point, &a) in one.points.iter().zip(&amplitudes) {
            let (f, zeta) = (mode.frequency_at(a).unwrap(), mode.damping_ratio_at(a).unwrap());
            assert!((point.frequency / f - 1.0).abs() < 1e-10, "{a} {} {f}", point.frequency);
            assert!((point.damping_ratio / zeta - 1.0).abs() < 1e-8, "{a} {} {zeta}", point.damping_ratio);
            assert!((point.amplitude / a - 1.0).abs() < 1e-12);
        }
        for (seven, one) in seven.points.iter().zip(&one.points) {
            assert!((seven.frequency / one.frequency - 1.0).abs() < 0.02, "{seven:?} {one:?}");
            assert_eq!(seven.response.len(), 4);
        }
    }
}

/// Two masses in a row on joints: stuck modes by hand.
fn chain(at_force: usize, at_output: usize) -> JointedModes {
    // Unit masses, wall - k + joint - 1 - k + joint - 2, everything equal: K = s [[2, -1], [-1, 1]].
    let (k, k_t) = (2e5, 1e5);
    let s: f64 = k + k_t;
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut modes = Vec::new();
    let mut participation = [Vec::new(), Vec::new()];
    for (square, shape) in [((2.0 - golden) * s, [1.0, golden]), ((1.0 + golden) * s, [golden, -1.0])] {
        let size = f64::hypot(shape[0], shape[1]);
        let shape = shape.map(|x: f64| x / size);
        let damping_ratio = 0.01;
        modes.push(StuckMode {
            omega: square.sqrt(),
            damping_ratio,
            at_force: shape[at_force],
            at_output: shape[at_output],
        });
        participation[0].push(shape[0]);
        participation[1].push(shape[1] - shape[0]);
    }
    let joint = |participation: Vec<f64>| SlipJoint {
        name: "joint".into(),
        law: JointLaw::FourParameter(FourParameter::new(k_t, 50.0, -0.3, 0.1).unwrap()).into(),
        participation,
    };
    JointedModes::new(modes, participation.map(joint).into(), Residual::default()).unwrap()
}

#[test]
fn two_joints_couple_two_modes() {
    let system = chain(1, 1);
    let frequencies: Vec<f64> = system.modes().iter().map(|m| m.omega / TAU).collect();
    let band = Sweep { from: 20.0, to: 200.0, ..sweep(Control::Force, &[0.5, 20.0, 45.0], 5) };
    for curve in forced_response_of(&system, &band).unwrap() {
        assert!(curve.remarks.is_empty(), "{:?}", curve.remarks);
        // Both resonances are on the curve.
        let tops: Vec<f64> = curve
            .points
            .windows(3)
            .filter(|w| w[1].amplitude > w[0].amplitude && w[1].amplitude > w[2].amplitude)
            .map(|w| w[1].frequency)
            .collect();
        for f in &frequencies {
            assert!(tops.iter().any(|top| (0.75 * f..1.01 * f).contains(top)), "{tops:?} {frequencies:?}");
        }
    }
    // The receptance is symmetric: force at 1, response at 2 is force at 2, response at 1 only while all is linear; of
    // nonlinear modes the frequency falls and the damping rises.
    let linear = Sweep { levels: vec![1e-10], ..band };
    let [a, b] = [chain(0, 1), chain(1, 0)]
        .map(|s| forced_response_of(&s, &linear).unwrap()[0].peak().unwrap().clone());
    assert!((a.amplitude / b.amplitude - 1.0).abs() < 1e-6, "{a:?} {b:?}");
    for mode in 0..2 {
        let onset = system.macro_slip(mode).unwrap();
        let amplitudes: Vec<f64> = (0..30).map(|i| onset * 1e-2 * 1.25_f64.powi(i)).collect();
        let curve = nonlinear_mode(&system, mode, 5, &amplitudes).unwrap();
        assert!(curve.remarks.is_empty(), "{:?}", curve.remarks);
        assert!(curve.points.windows(2).all(|w| w[0].frequency > w[1].frequency));
        let first = &curve.points[0];
        assert!((first.damping_ratio - 0.01).abs() < 5e-3 && first.slips.len() == 2, "{first:?}");
    }
}

#[test]
fn bad_systems_are_named() {
    let mode = StuckMode { omega: 0.0, damping_ratio: 0.0, at_force: 1.0, at_output: 1.0 };
    let error = JointedModes::new(vec![mode], Vec::new(), Residual::default()).unwrap_err().to_string();
    assert!(error.contains("frequency > 0"), "{error}");
    assert!(JointedModes::new(Vec::new(), Vec::new(), Residual::default()).is_err());
    let error = backbone(&mode_1(0.0), 1, &[1.0, 0.5]).unwrap_err().to_string();
    assert!(error.contains("amplitudes[1]"), "{error}");
    assert!(backbone(&mode_1(0.0), 2, &[1.0]).is_err());
    assert!(nonlinear_mode(&chain(0, 0), 7, 1, &[1.0]).is_err());
}
