//! Modes whose joint has dynamic below static friction: which methods run them, how good they say they are, and which refuse.
#![allow(clippy::unwrap_used, reason = "a failed test may panic and say why")]

use iwan_core::progress::UNWATCHED;
use iwan_core::{Backbone, FiveParameter, FourParameter, Grid, Motion, Pulse, Representation};
use iwan_sim::{
    Control, JointLaw, Method, Mode, Settings, SharedJoint, Sweep, check_coupled, force_history,
    forced_response, simulate,
};

fn law(theta: f64) -> FiveParameter {
    FiveParameter::new(4.45e4, 239.4, -0.183, 0.3, theta).unwrap()
}

fn mode(theta: f64) -> Mode {
    let joint = Some(JointLaw::FiveParameter(law(theta)));
    Mode { damping_ratio: 2.5e-4, ..Mode::new("bending 1", 124.0, joint) }
}

const BLOW: Pulse<'_> = Pulse::Haversine { amplitude: 1000.0, duration: 1.6e-3 };

fn settings(method: Method) -> Settings {
    Settings { method, ..Settings::new(2e-5, 0.2) }
}

fn sliders(bins: usize) -> Method {
    let joint = Representation::Sliders { bins, grid: Grid::graded(bins) };
    Method::Newmark { beta: 0.25, gamma: 0.5, prewarp: true, joint }
}

#[test]
fn steps_close_their_balance_and_say_how_good_they_are() {
    for mode in [mode(0.7), Mode { initial: Motion::held_at(1.4 * law(0.7).phi_max()), ..mode(0.7) }] {
        let found = simulate(&mode, &BLOW, &settings(sliders(100))).unwrap();
        assert!(found.energy.error() < 1e-10 && found.energy.friction > 0.0, "{:?}", found.energy);
        let finest = simulate(&mode, &BLOW, &settings(sliders(1600))).unwrap();
        let peak = finest.peak_displacement();
        let pairs = found.displacement.iter().zip(&finest.displacement);
        let error = pairs.fold(0.0_f64, |m, (a, b)| m.max((a - b).abs())) / peak;
        let told = found.quality.discretisation_error.unwrap();
        assert!(error < 3.0 * told + 1e-6 && told < 0.05, "{error} {told}");
        assert!(found.quality.time_step_error.unwrap() < 1e-3);
    }
}

#[test]
fn averaging_follows_the_steps() {
    let found = simulate(&mode(0.7), &BLOW, &settings(Method::Averaging)).unwrap();
    let steps = simulate(&mode(0.7), &BLOW, &settings(sliders(1600))).unwrap();
    let peak = steps.peak_displacement();
    let pairs = found.displacement.iter().zip(&steps.displacement);
    let error = pairs.fold(0.0_f64, |m, (a, b)| m.max((a - b).abs())) / peak;
    assert!(error < 0.02, "{error}");
    assert!(error < 2.0 * found.quality.time_step_error.unwrap() + 1e-3);
}

#[test]
fn what_rests_on_masing_s_rule_is_refused_by_name() {
    let refused = |method: Method, says: &str| {
        let text = simulate(&mode(0.7), &BLOW, &settings(method)).unwrap_err().to_string();
        assert!(text.contains("theta < 1") && text.contains(says), "{text}");
    };
    let grid = Grid::graded(10);
    refused(Method::HalfCycle, "newmark or averaging");
    refused(Method::Event { bins: 10, grid }, "newmark or averaging");
    let with = |beta, gamma, joint| Method::Newmark { beta, gamma, prewarp: false, joint };
    refused(with(0.25, 0.5, Representation::Continuum), "sliders");
    refused(with(0.3, 0.6, Representation::in_a_mode(10)), "gamma = 0.5");
    let joint = SharedJoint::new("bolt", JointLaw::FiveParameter(law(0.7)), vec![1.0], 1);
    let linear = [Mode::new("a", 124.0, None)];
    let text = check_coupled(&linear, &[joint], &settings(sliders(10))).unwrap_err().to_string();
    assert!(text.contains("theta < 1"), "{text}");
    let sweep = |harmonics| Sweep {
        from: 110.0,
        to: 130.0,
        control: Control::Force,
        levels: vec![20.0],
        harmonics,
        points: 50,
    };
    let text = forced_response(&mode(0.7), &sweep(3), 1.0).unwrap_err().to_string();
    assert!(text.contains("harmonics = 1"), "{text}");
    // The first harmonic is that of cycles reached from rest: at the peak the force equals what friction takes.
    let curves = forced_response(&Mode { damping_ratio: 0.0, ..mode(0.7) }, &sweep(1), 1.0).unwrap();
    let peak = curves[0].peak().unwrap().amplitude;
    assert!((law(0.7).dissipation(peak) / (std::f64::consts::PI * peak) / 20.0 - 1.0).abs() < 1e-6);
}

#[test]
fn without_a_drop_every_method_runs_it_as_the_four_parameter_joint() {
    let four = FourParameter::new(4.45e4, 239.4, -0.183, 0.3).unwrap();
    let four = Mode { joint: Some(JointLaw::FourParameter(four)), ..mode(1.0) };
    for method in [sliders(100), Method::HalfCycle, Method::Averaging] {
        let same = simulate(&mode(1.0), &BLOW, &settings(method)).unwrap();
        let exact = simulate(&four, &BLOW, &settings(method)).unwrap();
        let pairs = same.displacement.iter().zip(&exact.displacement);
        let error = pairs.fold(0.0_f64, |m, (a, b)| m.max((a - b).abs())) / exact.peak_displacement();
        assert!(error < 1e-9, "{method:?} {error}");
    }
}

#[test]
fn a_history_is_that_of_its_sliders() {
    let law = JointLaw::FiveParameter(law(0.6));
    let top = 2.0 * law.strengths().1;
    let joint = Representation::in_a_mode(50);
    let force = force_history(&law, &[top, 0.99 * top, top, -top], joint, UNWATCHED).unwrap();
    // All slide; turned round and on again all stick and pull more.
    assert!((force[0] - 0.6 * 239.4).abs() < 1e-9 && (force[3] + 0.6 * 239.4).abs() < 1e-9);
    assert!(force[1] < force[0] && force[2] >= force[0] - 1e-9);
    assert!(force_history(&law, &[top], Representation::Continuum, UNWATCHED).is_err());
}
