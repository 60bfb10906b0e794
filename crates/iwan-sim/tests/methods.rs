//! The methods against each other, through the whole of `simulate`.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a failed test may panic and say why")]

use iwan_core::progress::UNWATCHED;
use iwan_core::{FourParameter, Grid, Jenkins, Motion, Pulse, Representation, Uniform};
use iwan_sim::{
    JointLaw, Method, Mode, Response, Settings, SimulationError, simulate, simulate_all, superpose,
};

/// Mode 1 of Table 2 of Deaner et al. with a damper of 0.025 %.
fn mode() -> Mode {
    let joint = FourParameter::new(4.45e4, 239.4, -0.183, 0.3).unwrap();
    Mode { damping_ratio: 2.5e-4, ..Mode::new("bending 1", 124.0, Some(JointLaw::FourParameter(joint))) }
}

fn run(mode: &Mode, force: &Pulse<'_>, method: Method, dt: f64) -> Response {
    simulate(mode, force, &Settings { method, ..Settings::new(dt, 0.1) }).unwrap()
}

fn newmark(joint: Representation) -> Method {
    Method::Newmark { beta: 0.25, gamma: 0.5, prewarp: true, joint }
}

fn distance(a: &Response, b: &Response) -> f64 {
    let stride = ((a.steps()) / b.steps()).max(1);
    let pairs = a.displacement.iter().step_by(stride).zip(&b.displacement);
    pairs.fold(0.0_f64, |m, (x, y)| m.max((x - y).abs())) / b.peak_displacement()
}

const BLOW: Pulse<'static> = Pulse::Haversine { amplitude: 1000.0, duration: 1.6e-3 };

#[test]
fn all_methods_agree_on_a_blow() {
    let grid = Grid::Geometric { ratio: 1.0025 };
    let event = run(&mode(), &BLOW, Method::Event { bins: 4000, grid }, 1e-4);
    let map = run(&mode(), &BLOW, Method::HalfCycle, 1e-4);
    let continuum = run(&mode(), &BLOW, newmark(Representation::Continuum), 1e-5);
    let sliders = run(&mode(), &BLOW, newmark(Representation::default_sliders()), 1e-5);
    let averaging = run(&mode(), &BLOW, Method::Averaging, 1e-4);
    assert!(distance(&map, &event) < 2e-6, "map {}", distance(&map, &event));
    assert!(distance(&continuum, &event) < 2e-4, "continuum {}", distance(&continuum, &event));
    assert!(distance(&sliders, &event) < 2e-2, "sliders {}", distance(&sliders, &event));
    assert!(distance(&averaging, &event) < 5e-2, "averaging {}", distance(&averaging, &event));
    // The estimates beside the answers are of the size of the errors.
    let reported =
        |r: &Response| r.quality.time_step_error.unwrap() + r.quality.discretisation_error.unwrap();
    for (response, name) in
        [(&map, "map"), (&continuum, "continuum"), (&sliders, "sliders"), (&averaging, "averaging")]
    {
        let error = distance(response, &event);
        println!("{name}: error {error:e}, reported {:e}", reported(response));
        assert!(
            reported(response) > error / 3.0,
            "{name}: error {error:e}, reported {:e}",
            reported(response)
        );
        assert!(
            reported(response) < 3.0 * error,
            "{name}: error {error:e}, reported {:e}",
            reported(response)
        );
    }
    for response in [&event, &map, &continuum, &sliders] {
        assert!(response.energy.error() < 1e-10, "{:?}", response.energy);
        assert!(response.energy.friction > 0.0);
    }
    assert!((1e-6..1e-2).contains(&averaging.energy.error()), "{:?}", averaging.energy);
}

#[test]
fn every_pulse_gives_the_event_driven_response() {
    let samples: Vec<f64> = (0..40).map(|i| 300.0 * (0.7 * f64::from(i)).sin()).collect();
    let pulses = [
        Pulse::HalfSine { amplitude: 500.0, duration: 2.3e-3 },
        Pulse::Step { amplitude: 200.0, duration: f64::INFINITY },
        Pulse::Step { amplitude: 200.0, duration: 5.0137e-3 },
        Pulse::Sine { amplitude: 30.0, frequency: 118.0, duration: f64::INFINITY },
        Pulse::Sine { amplitude: 60.0, frequency: 124.0, duration: 0.0307 },
        Pulse::Sampled { dt: 1e-3, samples: &samples },
        Pulse::Haversine { amplitude: 30_000.0, duration: 1.6e-3 },
    ];
    for pulse in pulses {
        let event = run(&mode(), &pulse, Method::Event { bins: 100, grid: Grid::graded(100) }, 1e-4);
        let errors: Vec<f64> = [2e-5, 1e-5]
            .iter()
            .map(|dt| {
                distance(&run(&mode(), &pulse, newmark(Representation::default_sliders()), *dt), &event)
            })
            .collect();
        println!("{pulse:?}: {errors:?}");
        assert!(errors[1] < 2e-3, "{pulse:?}: {errors:?}");
        assert!(errors[1] < 0.5 * errors[0] || errors[1] < 1e-5, "{pulse:?}: {errors:?}");
        if pulse.settled() < 0.05 {
            let map = run(&mode(), &pulse, Method::HalfCycle, 1e-4);
            assert!(map.energy.error() < 1e-10, "{pulse:?}: {:?}", map.energy);
            let continuum = run(&mode(), &pulse, newmark(Representation::Continuum), 5e-6);
            assert!(distance(&continuum, &map) < 2e-4, "{pulse:?}: {}", distance(&continuum, &map));
        }
    }
}

#[test]
fn other_laws_and_linear_modes_take_every_method() {
    let laws = [
        Some(JointLaw::Jenkins(Jenkins::new(4e4, 20.0).unwrap())),
        Some(JointLaw::Uniform(Uniform::new(4e4, 60.0, 0.6).unwrap())),
        Some(JointLaw::tabulated(&[0.0, 1e-3, 4e-3], &[2e7, 1e7, 3e6], 5e3).unwrap()),
        None,
    ];
    for law in laws {
        let mode = Mode {
            damping_ratio: 1e-3,
            initial: Motion { displacement: 2e-4, velocity: 0.4 },
            ..Mode::new("m", 124.0, law)
        };
        let event = run(&mode, &BLOW, Method::Event { bins: 2000, grid: Grid::Uniform }, 1e-4);
        for method in [
            Method::HalfCycle,
            newmark(Representation::Continuum),
            newmark(Representation::default_sliders()),
        ] {
            let dt = if method == Method::HalfCycle { 1e-4 } else { 1e-5 };
            let response = run(&mode, &BLOW, method, dt);
            let error = distance(&response, &event);
            println!("{:?} {method:?}: {error:e}", mode.joint.is_some());
            assert!(error < 5e-3, "{:?} {method:?}: {error:e}", mode.joint);
            assert!(response.energy.error() < 1e-10, "{:?} {method:?}: {:?}", mode.joint, response.energy);
        }
    }
}

#[test]
fn threads_change_no_bit_and_points_add_up() {
    let modes: Vec<Mode> = (0..5)
        .map(|i| {
            let mut mode = mode();
            mode.name = format!("mode {i}");
            mode.frequency += 10.0 * f64::from(i);
            mode.outputs = vec![iwan_sim::Point { name: "tip".into(), shape: 1.0 + f64::from(i) }];
            mode
        })
        .collect();
    let settings = Settings::new(1e-5, 0.05);
    let all = |threads| simulate_all(&modes, &BLOW, &settings, threads, UNWATCHED).unwrap();
    let (one, four) = (all(1), all(4));
    for (a, b) in one.iter().zip(&four) {
        assert_eq!(a.displacement, b.displacement);
        assert_eq!(a.quality, b.quality);
    }
    let points = superpose(&modes, &one);
    assert_eq!(points.len(), 1);
    let n = 1234;
    let sum: f64 = modes.iter().zip(&one).map(|(m, r)| m.outputs[0].shape * r.velocity[n]).sum();
    assert!((points[0].1[1][n] - sum).abs() < 1e-12 * sum.abs());
}

#[test]
fn bad_values_are_named() {
    let message = |mode: &Mode, settings: Settings, force: Pulse<'_>| {
        simulate(mode, &force, &settings).unwrap_err().to_string()
    };
    let settings = Settings::new(1e-5, 0.1);
    assert!(message(&Mode { damping_ratio: -1.0, ..mode() }, settings, BLOW).contains("damping_ratio = -1"));
    assert!(message(&Mode { frequency: 20.0, ..mode() }, settings, BLOW).contains("k_t = 44500"));
    assert!(message(&mode(), Settings { dt: 0.0, ..settings }, BLOW).contains("time step = 0"));
    assert!(message(&mode(), Settings { duration: f64::NAN, ..settings }, BLOW).contains("duration = NaN"));
    assert!(
        message(&mode(), settings, Pulse::Step { amplitude: f64::NAN, duration: 1.0 }).contains("amplitude")
    );
    let endless = Pulse::Sine { amplitude: 1.0, frequency: 3.0, duration: f64::INFINITY };
    assert!(
        message(&mode(), Settings { method: Method::HalfCycle, ..settings }, endless).contains("settles")
    );
    let stop = simulate_all(&[mode()], &BLOW, &settings, 1, &|_| std::ops::ControlFlow::Break(()));
    assert_eq!(stop.unwrap_err(), SimulationError::Interrupted);
}

/// What the time step cannot see is refused, and companions that fail cost only their estimate.
#[test]
fn unseen_forces_and_failing_companions() {
    let settings = Settings::new(1e-5, 0.1);
    let short = Pulse::Haversine { amplitude: 300.0, duration: 0.9e-5 };
    let message = simulate(&mode(), &short, &settings).unwrap_err().to_string();
    assert!(message.contains("time step") && message.contains("quarter"), "{message}");
    let alias = Pulse::Sine { amplitude: 1.0, frequency: 100_124.0, duration: f64::INFINITY };
    assert!(simulate(&mode(), &alias, &settings).is_err());
    let joint = JointLaw::Jenkins(Jenkins::new(1e6, 20.0).unwrap());
    let soft = Mode { residual: iwan_core::ResidualStiffness::Any, ..Mode::new("m", 10.0, Some(joint)) };
    let response = simulate(&soft, &Pulse::None, &Settings::new(1.5e-3, 0.1)).unwrap();
    assert_eq!(response.quality.time_step_error, None);
    // A step shorter than the time step keeps its impulse.
    let tap = Pulse::Step { amplitude: 1000.0, duration: 1e-6 };
    let (coarse, exact) = (
        run(&mode(), &tap, newmark(Representation::Continuum), 1e-5),
        run(&mode(), &tap, Method::Event { bins: 2000, grid: Grid::graded(2000) }, 1e-5),
    );
    assert!(distance(&coarse, &exact) < 6e-3, "{}", distance(&coarse, &exact));
}

#[test]
fn overflow_is_never_silent() {
    for method in [Method::default_newmark(), Method::HalfCycle, Method::Averaging] {
        let huge = Pulse::Haversine { amplitude: 1e300, duration: 1.6e-3 };
        let result = simulate(&mode(), &huge, &Settings { method, ..Settings::new(1e-5, 0.05) });
        assert!(
            matches!(result, Err(SimulationError::NotFinite { .. })),
            "{method:?}: {:?}",
            result.map(|r| r.energy)
        );
    }
}

#[test]
fn the_map_claims_no_perfection() {
    let mode = Mode { initial: Motion::held_at(1e-3), ..mode() };
    let map = run(&mode, &Pulse::None, Method::HalfCycle, 1e-4);
    assert!(map.quality.time_step_error.unwrap() > 0.0);
    let event = run(&mode, &Pulse::None, Method::Event { bins: 50, grid: Grid::graded(50) }, 1e-5);
    assert!(event.quality.time_step_error.unwrap() > 0.0);
}
