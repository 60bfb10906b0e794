//! Parameters from shaker tests: recovery of the truth, coverage of the intervals, and fits of ring-downs and sweeps together.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use std::f64::consts::{PI, TAU};

use iwan_core::{Backbone, Decay, Motion, Reversal, Samples, SplitMix64};
use iwan_ident::curves::Quantity;
use iwan_ident::identify::{ModeRecord, Settings, identify};
use iwan_ident::sweeps::{ResponsePoint, SteadyData, fit_steady};
use iwan_ident::{Error, Grade, Parameter, Parameters};

const TRUTH: Parameters =
    Parameters { frequency: 124.0, damping_ratio: 5e-4, k_t: 4.45e4, f_s: 239.4, chi: -0.183, beta: 0.3 };

/// The two points of one amplitude on the response curve of a force level, below and above resonance; `drift` is the
/// relative shift of the frequency on that day.
fn pair(a: f64, force: f64, drift: f64) -> Option<[ResponsePoint; 2]> {
    let (oscillator, joint) = TRUTH.model().unwrap();
    let square = oscillator.omega0().powi(2);
    let k = oscillator.k_inf() + joint.harmonic_stiffness(a) + square * (2.0 * drift).exp_m1();
    let (c, h) = (2.0 * TRUTH.damping_ratio * oscillator.omega0(), joint.dissipation(a) / (PI * a * a));
    // |K - ω² + i(cω + h)| a = f, by fixed-point iteration: viscous damping is light.
    let at = |sign: f64| {
        let mut omega = k.sqrt();
        for _ in 0..50 {
            let rest = (force / a).powi(2) - (c * omega + h).powi(2);
            // NaN where the equation has no solution with a real frequency; such points are left out.
            omega = (k + sign * rest.sqrt()).sqrt();
        }
        let phase = (-(c * omega + h)).atan2(k - omega * omega);
        ResponsePoint { frequency: omega / TAU, amplitude: a, phase, force }
    };
    (force / a > c * k.sqrt() + h).then(|| [at(-1.0), at(1.0)])
}

/// Response curves at these forces, with relative noise.
fn swept(forces: &[f64], drift: f64, noise: f64, seed: u64) -> SteadyData {
    let mut stream = SplitMix64::new(seed);
    // Uniform random numbers of standard deviation 1.
    let mut random = || 3f64.sqrt() * stream.next_symmetric();
    let mut points = Vec::new();
    for force in forces {
        for i in 0..120 {
            let a = 3e-6 * 10f64.powf(f64::from(i) / 28.0);
            for mut point in pair(a, *force, drift).into_iter().flatten() {
                if (point.frequency / 124.0 - 1.0).abs() < 0.03 {
                    point.amplitude *= 1.0 + noise * random();
                    // Motion and force each have a phase of their own, with noise.
                    point.phase += noise * (random() + random());
                    point.force *= 1.0 + noise * random();
                    points.push(point);
                }
            }
        }
    }
    SteadyData::Response(points)
}

#[test]
fn without_noise_the_parameters_come_back() {
    let found = fit_steady(&[swept(&[2.0, 20.0, 150.0], 0.0, 0.0, 1)], None, &[]).unwrap();
    for p in Parameter::ALL {
        assert!((found.parameters.get(p) / TRUTH.get(p) - 1.0).abs() < 1e-4, "{found:?}");
    }
    assert!(found.verdict.adequate && found.others.abs() < 1e-9, "{:?}", found.verdict);
}

#[test]
fn intervals_hold_what_they_should() {
    let found = fit_steady(&[swept(&[2.0, 20.0, 150.0], 0.0, 0.01, 2)], None, &[]).unwrap();
    assert!((found.errors[0][0] / 0.01 - 1.0).abs() < 0.15, "{:?}", found.errors);
    assert_eq!(found.verdict.grade, Grade::Matches, "{:?}", found.verdict);
    for (profile, p) in found.profiles.iter().zip(Parameter::ALL) {
        let (low, high) = (profile.low.unwrap(), profile.high.unwrap());
        // The intervals are widened by half: a 95 % interval may miss the truth now and then.
        let room = 0.5 * (high - low);
        let truth = TRUTH.get(p);
        assert!((low - room..=high + room).contains(&truth), "{} {low} {high}", p.name());
        assert!(high - low < 0.3 * truth.abs(), "{} {low} {high}", p.name());
    }
}

#[test]
fn in_micro_slip_the_slip_force_is_open() {
    let found = fit_steady(&[swept(&[0.2, 1.0], 0.0, 0.01, 3)], None, &[]).unwrap();
    let of = |p: Parameter| &found.profiles[Parameter::ALL.iter().position(|q| *q == p).unwrap()];
    assert!(of(Parameter::FS).high.is_none() && of(Parameter::Beta).high.is_none(), "{found:?}");
    assert!(of(Parameter::Chi).identifiable(), "{found:?}");
    assert!(found.informed[1] < 0.1 * TRUTH.model().unwrap().1.phi_max(), "{:?}", found.informed);
}

#[test]
fn ring_downs_and_sweeps_of_other_days_are_fitted_together() {
    let (oscillator, joint) = TRUTH.model().unwrap();
    let (dt, mut out) = (2e-4, [vec![0.0; 3000], vec![0.0; 3000], vec![0.0; 3000], vec![0.0; 3000]]);
    let [displacement, velocity, acceleration, joint_force] = &mut out;
    let release = Motion::held_at(0.3 * joint.phi_max());
    Decay::new(&oscillator, &joint, 0.0, release, vec![Reversal::default(); 200])
        .unwrap()
        .sample(dt, &mut Samples { displacement, velocity, acceleration, joint_force })
        .unwrap();
    let record = ModeRecord { samples: &out[2], dt, quantity: Quantity::Acceleration };
    let alone = identify(&[record], &Settings::default()).unwrap();
    // Two days: the frequency of one is lower by two tenths of a per mille, that of the other higher.
    let days = [swept(&[5.0, 150.0], -2e-4, 1e-3, 4), swept(&[20.0], 3e-4, 1e-3, 5)];
    let found = fit_steady(&days, Some(&alone.likelihood), &[]).unwrap();
    assert!((found.drifts[0] + 2e-4).abs() < 3e-5 && (found.drifts[1] - 3e-4).abs() < 3e-5, "{found:?}");
    // The record is in micro-slip: only the sweep determines the slip force.
    let f_s = &found.profiles[3];
    assert!((f_s.value / TRUTH.f_s - 1.0).abs() < 0.02 && f_s.identifiable(), "{f_s:?}");
}

#[test]
fn what_cannot_be_used_is_named() {
    let refused = |data: &[SteadyData]| fit_steady(data, None, &[]).unwrap_err();
    assert!(matches!(refused(&[]), Error::OutOfRange { name: "measurements", .. }));
    let SteadyData::Response(mut points) = swept(&[20.0], 0.0, 0.0, 6) else { panic!() };
    assert!(matches!(refused(&[SteadyData::Response(points[..4].to_vec())]), Error::TooShort { .. }));
    // A phase of the wrong sign: the structure would take up no energy.
    let wrong = points.iter().map(|p| ResponsePoint { phase: -p.phase, ..*p }).collect();
    assert!(refused(&[SteadyData::Response(wrong)]).to_string().contains("sign of the phase"));
    points[3].amplitude = f64::NAN;
    assert!(matches!(refused(&[SteadyData::Response(points)]), Error::OutOfRange { name: "amplitude", .. }));
}

/// Knees (values of φ_max) a little below the largest amplitude, which only few points exceed. The only knees that fit the curves once lay
/// between those that were tried, and the search found a joint that sticks, with intervals that excluded the truth.
#[test]
fn a_knee_next_to_the_largest_amplitude_is_found() {
    for force in [92.0, 96.0, 100.0, 105.0, 110.0, 120.0] {
        for forces in [&[force][..], &[1.0, force]] {
            let SteadyData::Response(points) = swept(forces, 0.0, 0.0, 1) else { unreachable!() };
            let thin = SteadyData::Response(points.into_iter().step_by(3).collect());
            let found = fit_steady(&[thin], None, &[]).unwrap();
            let off = |p: Parameter| (found.parameters.get(p) / TRUTH.get(p) - 1.0).abs();
            assert!(found.errors[0][0] < 1e-6, "{forces:?} {:?} {:?}", found.errors, found.parameters);
            assert!(
                off(Parameter::Frequency) < 1e-7 && off(Parameter::Chi) < 1e-4,
                "{forces:?} {:?}",
                found.parameters
            );
        }
    }
}
