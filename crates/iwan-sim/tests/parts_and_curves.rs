//! Modes with parts and modes by their curves, through the whole of `simulate`.
#![allow(clippy::unwrap_used, reason = "a failed test may panic and say why")]

use iwan_core::{
    Coulomb, FourParameter, Motion, Part, Pinning, PowerDamping, PowerSpring, Pulse, Representation,
};
use iwan_sim::{Curves, JointLaw, Method, Mode, Response, Settings, SimulationError, simulate};

const BLOW: Pulse<'static> = Pulse::Haversine { amplitude: 1000.0, duration: 1.6e-3 };

/// Mode 1 of Table 2 of Deaner et al. with a damper of 0.025 %.
fn iwan_mode() -> Mode {
    let joint = FourParameter::new(4.45e4, 239.4, -0.183, 0.3).unwrap();
    Mode { damping_ratio: 2.5e-4, ..Mode::new("bending 1", 124.0, Some(JointLaw::FourParameter(joint))) }
}

fn with_parts() -> Mode {
    let parts = vec![
        PowerDamping::new(0.05, 2.0).unwrap().into(),
        Coulomb::new(0.5).unwrap().into(),
        PowerSpring::new(-3e8, 3.2).unwrap().into(),
        Pinning::new(1e5, 1e-3).unwrap().into(),
    ];
    Mode { parts, ..iwan_mode() }
}

fn newmark(joint: Representation) -> Method {
    Method::Newmark { beta: 0.25, gamma: 0.5, prewarp: true, joint }
}

fn run(mode: &Mode, force: &Pulse<'_>, method: Method, dt: f64) -> Response {
    simulate(mode, force, &Settings { method, ..Settings::new(dt, 0.1) }).unwrap()
}

fn distance(a: &Response, b: &Response) -> f64 {
    let pairs = a.displacement.iter().zip(&b.displacement);
    pairs.fold(0.0_f64, |m, (x, y)| m.max((x - y).abs())) / b.peak_displacement()
}

#[test]
fn a_mode_with_parts_runs_by_steps_and_by_averaging() {
    let sliders = run(&with_parts(), &BLOW, newmark(Representation::default_sliders()), 1e-5);
    let continuum = run(&with_parts(), &BLOW, newmark(Representation::Continuum), 1e-5);
    let averaging = run(&with_parts(), &BLOW, Method::Averaging, 1e-5);
    assert!(distance(&sliders, &continuum) < 1e-3, "{}", distance(&sliders, &continuum));
    assert!(distance(&averaging, &continuum) < 0.02, "{}", distance(&averaging, &continuum));
    for response in [&sliders, &continuum] {
        assert!(response.energy.error() < 1e-11, "{:?}", response.energy);
        assert!(response.quality.time_step_error.unwrap() < 1e-3);
    }
    assert!(sliders.quality.discretisation_error.unwrap() < 1e-3);
    assert!(averaging.energy.error() < 0.02, "{:?}", averaging.energy);
    // The error that averaging tells of is that against the steps.
    let told = averaging.quality.time_step_error.unwrap();
    assert!((told / distance(&continuum, &averaging) - 1.0).abs() < 0.1, "{told}");
}

/// Without parts the fast path runs, and with parts that do nothing the general one: the same to rounding.
#[test]
fn parts_that_do_nothing_change_nothing() {
    let idle: Vec<Part> = vec![Coulomb::new(0.0).unwrap().into(), PowerSpring::new(0.0, 3.0).unwrap().into()];
    let idle = Mode { parts: idle, ..iwan_mode() };
    for joint in [Representation::default_sliders(), Representation::Continuum] {
        let (fast, general) =
            (run(&iwan_mode(), &BLOW, newmark(joint), 1e-5), run(&idle, &BLOW, newmark(joint), 1e-5));
        assert!(distance(&general, &fast) < 1e-9, "{}", distance(&general, &fast));
        assert_eq!(fast.strongest, general.strongest);
    }
}

#[test]
fn what_a_method_does_not_cover_is_said_with_the_method_that_does() {
    let by_curves = Mode::by_curves("c", curves());
    for mode in [with_parts(), by_curves] {
        for method in [Method::HalfCycle, Method::Event { bins: 10, grid: iwan_core::Grid::Uniform }] {
            let settings = Settings { method, ..Settings::new(1e-4, 0.1) };
            let refused = simulate(&mode, &BLOW, &settings).unwrap_err().to_string();
            assert!(refused.contains("needs newmark or averaging"), "{refused}");
        }
        let damped =
            Method::Newmark { beta: 0.3, gamma: 0.6, prewarp: false, joint: Representation::Continuum };
        let settings = Settings { method: damped, ..Settings::new(1e-4, 0.1) };
        assert!(simulate(&mode, &BLOW, &settings).unwrap_err().to_string().contains("gamma = 0.5 only"));
    }
    let both = Mode { joint: iwan_mode().joint, ..Mode::by_curves("both", curves()) };
    let refused = simulate(&both, &BLOW, &Settings::new(1e-4, 0.1)).unwrap_err().to_string();
    assert!(refused.contains("in place of joint"), "{refused}");
}

/// A spring that softens beyond all stiffness lets the mode run away: said as such, not as an overflow.
#[test]
fn a_mode_that_runs_away_is_named() {
    let soft = vec![PowerSpring::new(-1e9, 3.0).unwrap().into()];
    let mode = Mode { parts: soft, initial: Motion::held_at(0.1), ..Mode::new("soft", 10.0, None) };
    let settings = Settings::new(1e-3, 1.0);
    let refused = simulate(&mode, &Pulse::None, &settings).unwrap_err();
    assert!(matches!(refused, SimulationError::NoStiffness { .. }), "{refused}");
    assert!(refused.to_string().contains("soften"), "{refused}");
    let averaged =
        simulate(&mode, &Pulse::None, &Settings { method: Method::Averaging, ..settings }).unwrap_err();
    assert!(averaged.to_string().contains("softens"), "{averaged}");
}

/// 40 points of the Iwan mode's own curves.
fn curves() -> Curves {
    let mode = iwan_mode();
    let phi_max = iwan_core::Backbone::strengths(mode.joint.as_ref().unwrap()).1;
    let a: Vec<f64> = (0..40).map(|i| phi_max * 10.0_f64.powf(-4.0 + 4.0 * f64::from(i) / 39.0)).collect();
    let f = a.iter().map(|a| mode.frequency_at(*a).unwrap()).collect();
    let z = a.iter().map(|a| mode.damping_ratio_at(*a).unwrap()).collect();
    Curves::new(a, f, z).unwrap()
}

/// Under the paper's blow the curves of the Iwan mode follow it within 1 % of the peak, by steps and by averaging.
#[test]
fn curves_follow_the_mode_that_they_were_made_from() {
    let by_curves = Mode::by_curves("c", curves());
    let truth = run(&iwan_mode(), &BLOW, newmark(Representation::Continuum), 1e-5);
    let steps = run(&by_curves, &BLOW, Method::default_newmark(), 1e-5);
    let slow = run(&by_curves, &BLOW, Method::Averaging, 1e-5);
    assert!(distance(&steps, &truth) < 0.01, "{}", distance(&steps, &truth));
    assert!(distance(&slow, &steps) < 2e-3, "{}", distance(&slow, &steps));
    assert!(steps.energy.error() < 1e-12 && steps.quality.time_step_error.unwrap() < 1e-3);
    assert_eq!(steps.quality.outside_curves, iwan_sim::OutsideCurves::default());
    assert_eq!(
        by_curves.frequency_at(1e-3).unwrap(),
        by_curves.curves.as_ref().unwrap().points().at(1e-3).omega / std::f64::consts::TAU
    );
}

#[test]
fn leaving_the_curves_is_never_silent() {
    let largest = curves().points().range().1;
    let released = |share: f64, curves: Curves| {
        let mode = Mode { initial: Motion::held_at(share * largest), ..Mode::by_curves("c", curves) };
        simulate(&mode, &Pulse::None, &Settings::new(1e-5, 0.05))
    };
    // At the largest amplitude itself it is within.
    assert!(released(1.0, curves()).is_ok());
    let refused = released(1.1, curves()).unwrap_err();
    let SimulationError::BeyondCurves { amplitude, time, .. } = refused else { panic!("{refused}") };
    assert!((amplitude / (1.1 * largest) - 1.0).abs() < 1e-12 && time == 0.0);
    assert!(refused.to_string().contains("extrapolate = true"), "{refused}");
    let allowed = released(1.1, curves().extrapolating(true)).unwrap();
    assert_eq!(allowed.quality.outside_curves.above_from, Some(0.0));
    // The amplitude falls by ζ ω t = 0.00025 · 779 · t, 0.5 % in 0.0257 s.
    let below = released(1.005e-4, curves()).unwrap().quality.outside_curves.below_from.unwrap();
    let rate = |a: f64| {
        let at = curves().points().at(a);
        at.damping_ratio * at.omega
    };
    assert!((below / (1.005_f64.ln() / rate(1e-4 * largest)) - 1.0).abs() < 0.02, "{below}");
    assert_eq!(released(1e-6, curves()).unwrap().quality.outside_curves.below_from, Some(0.0));
}
