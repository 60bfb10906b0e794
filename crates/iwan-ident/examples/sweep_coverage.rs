//! How often the 95 % intervals of stepped-sine tests hold the truth: `sweep_coverage COUNT`, run by `scripts/validate`.
//!
//! Mode 1 of Table 2 at three forces, force and motion with 1 % of noise each: once into macro-slip, once at a tenth of it.
#![allow(clippy::print_stdout, reason = "the output is what it is for")]

use std::f64::consts::PI;

use iwan_core::{Backbone, SplitMix64};
use iwan_ident::sweeps::{ResponsePoint, SteadyData, fit_steady};
use iwan_ident::{Error, Parameter, Parameters};

const TRUTH: Parameters =
    Parameters { frequency: 124.0, damping_ratio: 2.5e-4, k_t: 4.45e4, f_s: 239.4, chi: -0.183, beta: 0.3 };
/// Relative standard deviation of every measured number.
const NOISE: f64 = 0.01;
/// Amplitudes of a curve, each with its point below and above resonance.
const AMPLITUDES: u32 = 50;
/// The farthest point from 124 Hz: a band of 6 %.
const BAND: f64 = 0.03;

fn main() -> Result<(), Error> {
    let count = std::env::args().nth(1).and_then(|n| n.parse().ok()).unwrap_or(200);
    for (name, forces) in [("macro-slip", [1.0, 10.0, 100.0]), ("micro-slip", [0.1, 0.3, 1.0])] {
        let (mut held, mut closed) = ([0_u32; 6], [0_u32; 6]);
        // Errors of the estimates over the half width of their intervals, where these are closed: sum and sum of squares.
        let mut errors = [[0.0; 2]; 6];
        for seed in 0..count {
            let found = fit_steady(&[measured(&forces, seed)?], None, &[])?;
            for (n, profile) in found.profiles.iter().enumerate() {
                let truth = TRUTH.get(Parameter::ALL[n]);
                let inside = profile.low.is_none_or(|low| low <= truth)
                    && profile.high.is_none_or(|high| truth <= high);
                held[n] += u32::from(inside);
                closed[n] += u32::from(profile.identifiable());
                if let (Some(low), Some(high)) = (profile.low, profile.high) {
                    let error = 2.0 * (profile.value - truth) / (high - low);
                    errors[n] = [errors[n][0] + error, errors[n][1] + error * error];
                }
            }
        }
        println!(
            "{name}, {count} tests: parameter, intervals that hold the truth, closed on both sides; of these the mean error over the \
             half width, and its root mean square (0 and 0.51 are right)"
        );
        for (n, parameter) in Parameter::ALL.into_iter().enumerate() {
            let [sum, squares] = errors[n].map(|sum| sum / f64::from(closed[n]));
            let name = parameter.name();
            println!("  {name:<14}{:>6}{:>6}{sum:>9.2}{:>8.2}", held[n], closed[n], squares.sqrt());
        }
    }
    Ok(())
}

/// A test with noise of its own.
fn measured(forces: &[f64], seed: u64) -> Result<SteadyData, Error> {
    let (oscillator, joint) = TRUTH.model()?;
    let c = 2.0 * TRUTH.damping_ratio * oscillator.omega0();
    let mut stream = SplitMix64::new(seed);
    // Four uniform numbers have nearly a normal sum; each has the variance 1/3.
    let mut random = || 0.75_f64.sqrt() * (0..4).map(|_| stream.next_symmetric()).sum::<f64>();
    let mut points = Vec::new();
    for force in forces {
        let largest = 2.0 * joint.phi_max();
        for i in 0..AMPLITUDES {
            let a = largest * 10f64.powf(-4.0 * f64::from(i) / f64::from(AMPLITUDES));
            let (k, h) =
                (oscillator.k_inf() + joint.harmonic_stiffness(a), joint.dissipation(a) / (PI * a * a));
            for sign in [-1.0, 1.0] {
                let mut omega = k.sqrt();
                for _ in 0..20 {
                    omega = (k + sign * ((force / a).powi(2) - (c * omega + h).powi(2)).sqrt()).sqrt();
                }
                let frequency = omega / (2.0 * PI);
                // NaN where the force does not reach the amplitude.
                if (frequency / TRUTH.frequency - 1.0).abs() < BAND {
                    let phase = (-(c * omega + h)).atan2(k - omega * omega);
                    points.push(ResponsePoint {
                        frequency,
                        amplitude: a * (1.0 + NOISE * random()),
                        phase: phase + NOISE * (random() + random()),
                        force: force * (1.0 + NOISE * random()),
                    });
                }
            }
        }
    }
    Ok(SteadyData::Response(points))
}
