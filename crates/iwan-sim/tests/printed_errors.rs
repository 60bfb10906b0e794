//! Printed errors beside true ones, where they were too small or far too large: forces from files whose samples do not lie on the steps, sliders under a random
//! force, forces that end on a sample, the half-cycle map on a density with corners, modes that share a joint, averaging at coarse samples. References: the continuum at a fortieth of the step, at two steps extrapolated.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a failed test may panic and say why")]

use iwan_core::progress::UNWATCHED;
use iwan_core::{
    Coulomb, FourParameter, Motion, Part, PowerDamping, PowerSpring, Pulse, Representation, SplitMix64,
};
use iwan_sim::{
    CoupledResponse, Curves, JointLaw, Method, Mode, Response, Settings, SharedJoint, simulate,
    simulate_coupled,
};

/// Most times that an error may be larger than it is said to be, or smaller.
const FACTOR: f64 = 3.0;

fn mode() -> Mode {
    let joint = FourParameter::new(4.45e4, 239.4, -0.183, 0.3).unwrap();
    Mode { damping_ratio: 2.5e-4, ..Mode::new("bending 1", 124.0, Some(JointLaw::FourParameter(joint))) }
}

fn newmark(joint: Representation) -> Method {
    Method::Newmark { beta: 0.25, gamma: 0.5, prewarp: true, joint }
}

/// Numbers between -1 and 1.
fn random(seed: u64, count: usize) -> Vec<f64> {
    let mut random = SplitMix64::new(seed);
    (0..count).map(|_| random.next_symmetric()).collect()
}

/// Continuum at a fortieth of the step, at the samples of the step, extrapolated from twice that.
fn reference(mode: &Mode, force: &Pulse<'_>, dt: f64, duration: f64) -> Vec<f64> {
    reference_in(40, mode, force, [dt, duration])
}

/// The same at any part of the step, such as one that the samples of a file stand on.
fn reference_in(parts: usize, mode: &Mode, force: &Pulse<'_>, [dt, duration]: [f64; 2]) -> Vec<f64> {
    let at = |parts: usize| {
        let method = newmark(Representation::Continuum);
        let settings = Settings { method, quality: false, ..Settings::new(dt / parts as f64, duration) };
        let fine = simulate(mode, force, &settings).unwrap();
        fine.displacement.into_iter().step_by(parts).collect::<Vec<f64>>()
    };
    at(parts).iter().zip(at(parts / 2)).map(|(fine, coarse)| fine + (fine - coarse) / 3.0).collect()
}

fn error(response: &Response, exact: &[f64]) -> f64 {
    let pairs = response.displacement.iter().zip(exact);
    pairs.fold(0.0_f64, |most, (a, b)| most.max((a - b).abs())) / response.peak_displacement()
}

fn told(response: &Response) -> f64 {
    response.quality.time_step_error.unwrap() + response.quality.discretisation_error.unwrap()
}

fn hold(what: &str, is: f64, said: f64) {
    println!("{what}: is {is:.2e}, said {said:.2e}");
    assert!(said * FACTOR > is && said < FACTOR * is, "{what}: is {is:e}, said {said:e}");
}

/// Errors were told 3 to 9 times too small, and once 190 % of the peak as 27 %; sliders' 4 to 6 times. Later the motion of a linear mode under what is not seen made them up to 54
/// times too large, where the joint takes out what such a mode keeps.
#[test]
fn forces_from_files_at_any_interval() {
    let (dt, duration) = (1e-4, 0.04);
    for (seed, share) in [0.1, 0.25, 1.0, 2.5, 7.5].into_iter().enumerate() {
        for level in [200.0, 3000.0] {
            let count = (0.03 / (share * dt)) as usize;
            let samples: Vec<f64> = random(seed as u64 + 7, count).iter().map(|x| level * x).collect();
            let force = Pulse::Sampled { dt: share * dt, samples: &samples };
            let exact = reference(&mode(), &force, dt, duration);
            for joint in [Representation::Continuum, Representation::default_sliders()] {
                let settings = Settings { method: newmark(joint), ..Settings::new(dt, duration) };
                let response = simulate(&mode(), &force, &settings).unwrap();
                let what = format!("interval {share} of a step, {level}, {joint:?}");
                hold(&what, error(&response, &exact), told(&response));
            }
        }
    }
}

/// The double step of a force that ends between steps lost its end: errors were told 30 to 80 times too large.
#[test]
fn forces_that_end_between_steps() {
    let (dt, duration) = (1e-4, 0.1);
    for joint in [Representation::Continuum, Representation::default_sliders()] {
        let (mut is, mut said) = (0.0, 0.0);
        for end in 0..10 {
            let force = Pulse::Step { amplitude: 100.0, duration: (20.0 + 0.137 * f64::from(end)) * dt };
            let exact = reference(&mode(), &force, dt, duration);
            let settings = Settings { method: newmark(joint), ..Settings::new(dt, duration) };
            let response = simulate(&mode(), &force, &settings).unwrap();
            is += error(&response, &exact);
            said += told(&response);
        }
        hold(&format!("{joint:?}"), is, said);
    }
}

/// Behind a force that ends on a sample the last half of its last step was lost to the half-cycle map and to averaging: 2.8e-4 of the peak, told as 8.5e-5.
#[test]
fn forces_that_end_on_a_sample() {
    let (dt, duration) = (1e-4, 0.1);
    let samples = [100.0; 21];
    for force in [
        Pulse::Step { amplitude: 100.0, duration: 20.0 * dt },
        Pulse::Sine { amplitude: 100.0, frequency: 1.25e2, duration: 20.0 * dt },
        Pulse::Sampled { dt, samples: &samples },
    ] {
        let exact = reference(&mode(), &force, dt, duration);
        let settings = Settings { method: Method::HalfCycle, ..Settings::new(dt, duration) };
        let response = simulate(&mode(), &force, &settings).unwrap();
        let (is, said) = (error(&response, &exact), told(&response));
        println!("{force:?}: is {is:.2e}, said {said:.2e}");
        assert!(is < 1e-6 && said * FACTOR > is, "{force:?}: is {is:e}, said {said:e}");
    }
}

/// The half-cycle map steps the force of a file finely, and what lay between its fine steps was told 3 to 6 times too small; the steps now do as the file does.
/// The acceleration is that under the file itself.
#[test]
fn the_half_cycle_map_behind_a_force_from_a_file() {
    let (dt, duration) = (1e-4, 0.1);
    for share in [0.49, 4.37, 7.98] {
        let samples: Vec<f64> = random(5, (0.04 / (share * dt)) as usize).iter().map(|x| 500.0 * x).collect();
        let force = Pulse::Sampled { dt: share * dt, samples: &samples };
        let exact = reference_in(400, &mode(), &force, [dt, duration]);
        let settings = Settings { method: Method::HalfCycle, ..Settings::new(dt, duration) };
        let response = simulate(&mode(), &force, &settings).unwrap();
        let (is, said) = (error(&response, &exact), told(&response));
        println!("interval {share} of a step: is {is:.2e}, said {said:.2e}");
        assert!(is < 2e-5 && said * FACTOR > is, "{share}: is {is:e}, said {said:e}");
        let (omega, zeta) = (std::f64::consts::TAU * 124.0, 2.5e-4);
        let k_inf = omega * omega - 4.45e4;
        for n in (0..300).step_by(10) {
            let Response { displacement: q, velocity: v, acceleration: a, joint_force: f, .. } = &response;
            let inertia = force.at(n as f64 * dt) - 2.0 * zeta * omega * v[n] - k_inf * q[n] - f[n];
            assert!((a[n] - inertia).abs() < 1e-6 * 500.0, "{share}, {n}: {} {inertia}", a[n]);
        }
    }
}

/// Modes that share a joint told the errors under a file by the double step alone.
#[test]
fn modes_that_share_a_joint_under_a_force_from_a_file() {
    let law = JointLaw::FourParameter(FourParameter::new(3.16e4, 143.8, -0.3, 0.02).unwrap());
    let modes = [Mode::new("bending 1", 132.35, None), Mode::new("bending 3", 719.6, None)];
    let joint =
        SharedJoint { compliance: vec![9.1e-6], ..SharedJoint::new("link", law, vec![1.0, -4.905], 1) };
    let (dt, duration) = (5e-5, 0.04);
    let run = |force: &Pulse<'_>, parts: usize, joint_as| {
        let settings = Settings { method: newmark(joint_as), ..Settings::new(dt / parts as f64, duration) };
        simulate_coupled(&modes, std::slice::from_ref(&joint), force, &settings, 1, UNWATCHED).unwrap()
    };
    for share in [0.1, 2.5] {
        let samples: Vec<f64> =
            random(9, (0.03 / (share * dt)) as usize).iter().map(|x| 2000.0 * x).collect();
        let force = Pulse::Sampled { dt: share * dt, samples: &samples };
        let [fine, coarse] = [40, 20].map(|parts| (parts, run(&force, parts, Representation::Continuum)));
        for joint_as in [Representation::Continuum, Representation::default_sliders()] {
            let response = run(&force, 1, joint_as);
            for (r, mode) in response.modes.iter().enumerate() {
                let at = |(parts, run): &(usize, CoupledResponse)| -> Vec<f64> {
                    run.modes[r].displacement.iter().copied().step_by(*parts).collect()
                };
                let exact: Vec<f64> =
                    at(&fine).iter().zip(at(&coarse)).map(|(f, c)| f + (f - c) / 3.0).collect();
                hold(&format!("{share}, {joint_as:?}, mode {r}"), error(mode, &exact), told(mode));
            }
        }
    }
}

/// Half-cycle said 5e-7 whatever the density; corners cost up to 24 times as much. Carried on from four cycles the error was told 60 times too large far in macro-slip.
#[test]
fn the_half_cycle_map_on_a_density_with_corners_and_far_in_macro_slip() {
    let corners = [0.0, 1e-4, 4e-4, 5e-4, 2e-3, 5e-3];
    let tabulated = JointLaw::tabulated(&corners, &[4e6, 3e7, 1e6, 2e7, 3e6, 1e6], 5e3).unwrap();
    let spring = iwan_core::Backbone::initial_stiffness(&tabulated);
    assert!((1e4..4e5).contains(&spring), "{spring}");
    let cases = [
        (Mode { damping_ratio: 0.1, ..Mode::new("corners", 124.0, Some(tabulated.clone())) }, 4e-3),
        (Mode { damping_ratio: 1e-3, ..Mode::new("corners", 124.0, Some(tabulated)) }, 1e-3),
        (mode(), 5.0),
    ];
    for (mode, start) in cases {
        let mode = Mode { initial: Motion::held_at(start), ..mode };
        let (dt, duration) = (1e-4, 0.1);
        let exact = reference(&mode, &Pulse::None, dt, duration);
        let settings = Settings { method: Method::HalfCycle, ..Settings::new(dt, duration) };
        let response = simulate(&mode, &Pulse::None, &settings).unwrap();
        hold(&format!("{}, {start}", mode.name), error(&response, &exact), told(&response));
    }
}

/// Averaging was compared with time steps at the sampling interval, whose own error was told as that of averaging: up to 113 times too much.
#[test]
fn averaging_at_coarse_samples() {
    let blow = Pulse::Haversine { amplitude: 100.0, duration: 1.6e-3 };
    let with = |parts: Vec<Part>| Mode { parts, ..mode() };
    let damper = PowerDamping::new(0.05, 2.0).unwrap().into();
    let (spring, friction) = (PowerSpring::new(3e8, 3.0).unwrap().into(), Coulomb::new(0.05).unwrap().into());
    let linear = Mode { joint: None, ..with(vec![damper]) };
    let (frequency, damping) = (vec![124.0, 123.9, 123.4, 121.0], vec![5e-4, 6e-4, 1.5e-3, 4e-3]);
    let curves = Curves::new(vec![1e-6, 1e-5, 1e-4, 1e-3], frequency, damping).unwrap();
    let cases = [
        ("damper", linear),
        ("damper beside a joint", with(vec![damper])),
        ("spring", with(vec![spring])),
        ("dry friction", with(vec![friction])),
        ("curves", Mode::by_curves("curves", curves)),
    ];
    for (name, mode) in cases {
        for per_cycle in [4.0, 9.0, 30.0, 100.0] {
            let (dt, duration) = (1.0 / (124.0 * per_cycle), 0.2);
            let parts = 40 * (100.0 / per_cycle) as usize;
            let exact = reference_in(parts, &mode, &blow, [dt, duration]);
            let settings = Settings { method: Method::Averaging, ..Settings::new(dt, duration) };
            let response = simulate(&mode, &blow, &settings).unwrap();
            hold(&format!("{name}, {per_cycle} samples a cycle"), error(&response, &exact), told(&response));
        }
    }
}
