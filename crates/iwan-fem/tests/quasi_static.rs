//! Modal curves from static loads against a second program that shares no code with the library (tests/peers/beam.py of the project
//! prints its numbers), Masing's rule, and a ring-down in one mode.
#![allow(clippy::unwrap_used, reason = "a failed test may panic")]

use std::f64::consts::PI;

use iwan_core::Pulse;
use iwan_fem::mesh::beam::Configuration;
use iwan_fem::{Basis, Limit, Representation, Transient, paper};

/// Configuration A, mode 1: frequency and loss per cycle as tests/peers/beam.py prints them.
#[test]
fn curves_are_those_of_a_second_program_and_obey_masing() {
    let assembled = paper::structure(Configuration::A, 1).unwrap().assemble().unwrap();
    let stuck = assembled.modes(Limit::Stuck, 8).unwrap();
    let slipping = assembled.modes(Limit::Slipping, 16).unwrap();
    let pair = assembled.joint_modes(&stuck, &slipping)[0];
    let analysis = assembled.quasi_static(&stuck, 6, slipping.eigenvalue(pair.slipping)).unwrap();
    let expected = [
        (1.989e-4, 132.2419, 4.726e-5),
        (1.983e-3, 131.7558, 2.693e-2),
        (9.949e-3, 129.8895, 3.233),
        (4.981e-2, 128.2020, 37.32),
    ];
    let curves = analysis.curves(&expected.map(|e| e.0)).unwrap();
    for (i, (q, frequency, dissipation)) in expected.into_iter().enumerate() {
        let (f, d) = (curves.frequency[i], curves.dissipation[i]);
        assert!((f - frequency).abs() < 0.01, "{q}: {f} Hz, expected {frequency}");
        assert!((d / dissipation - 1.0).abs() < 0.01, "{q}: {d}, expected {dissipation}");
        // D = 8 ∫α dq - 4 α q over the virgin curve, here by Simpson's rule.
        let n = 400;
        let path: Vec<f64> = (1..=n).map(|k| q * f64::from(k) / f64::from(n)).collect();
        let force = analysis.curves(&path).unwrap().force;
        let weight = |k: usize| {
            if k == force.len() {
                1.0
            } else if k % 2 == 1 {
                4.0
            } else {
                2.0
            }
        };
        let work: f64 =
            (1..=force.len()).map(|k| weight(k) * force[k - 1]).sum::<f64>() * q / f64::from(n) / 3.0;
        let masing = 8.0 * work - 4.0 * force[force.len() - 1] * q;
        assert!((masing / d - 1.0).abs() < 2e-3, "{q}: Masing {masing}, joints {d}");
    }
    assert!(curves.joint_force.windows(2).all(|w| w[1] > w[0]));
    assert!(analysis.curves(&[-1.0]).is_err());
    assert!(assembled.quasi_static(&stuck, 2, 0.0).is_err());
}

/// A ring-down that starts in mode 1 alone loses as much energy as the static curve states, within 1 % in micro-slip.
#[test]
fn a_ring_down_in_one_mode_follows_the_curves() {
    let assembled = paper::structure(Configuration::A, 1).unwrap().assemble().unwrap();
    let reduced = assembled.reduce(50, Basis::default()).unwrap();
    let modes = reduced.modes();
    let analysis = assembled.quasi_static(modes, 6, 6.4445e5).unwrap();
    let omega = modes.eigenvalue(6).sqrt();
    for amplitude in [2e-4, 1e-3] {
        let response = reduced
            .transient(&Transient {
                dt: 1e-5,
                steps: 10_000,
                pulse: Pulse::None,
                load: vec![0.0; assembled.unknowns()],
                initial_velocity: Some(modes.shape(6).iter().map(|phi| omega * amplitude * phi).collect()),
                representation: Representation::Continuum,
                outputs: vec![assembled.modal_output("bending 1", modes, 6)],
            })
            .unwrap();
        // Energy of the mode at its zero crossings, which gives amplitude and loss per cycle.
        let (x, v) = (&response.outputs[0].displacement, &response.outputs[0].velocity);
        let crossings: Vec<(f64, f64)> = (1..x.len())
            .filter(|&n| x[n - 1] < 0.0 && x[n] >= 0.0)
            .map(|n| {
                let part = x[n - 1] / (x[n - 1] - x[n]);
                (1e-5 * (n as f64 - 1.0 + part), v[n - 1] + part * (v[n] - v[n - 1]))
            })
            .collect();
        let (first, last) = (crossings[1], crossings[crossings.len() - 1]);
        let cycles = (crossings.len() - 2) as f64;
        let loss = 0.5 * (first.1.powi(2) - last.1.powi(2)) / cycles;
        let frequency = cycles / (last.0 - first.0);
        // The loss of the static curve, averaged over the amplitudes of the cycle.
        let q: Vec<f64> = crossings[1..].iter().map(|c| c.1 / (2.0 * PI * frequency)).collect();
        let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
        let curves = analysis.curves(&q).unwrap();
        let (d, f) = (mean(&curves.dissipation), mean(&curves.frequency));
        assert!((loss / d - 1.0).abs() < 0.01, "{amplitude}: loss {loss}, static {d}");
        assert!((frequency - f).abs() < 0.02, "{amplitude}: {frequency} Hz, static {f}");
    }
}
