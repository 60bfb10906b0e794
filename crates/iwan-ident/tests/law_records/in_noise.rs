//! Ring-downs, in white noise, of random joints in the range of measured structures.

use std::f64::consts::TAU;

use iwan_core::{Decay, Motion, Reversal, Samples, SplitMix64};
use iwan_ident::{Error, Parameters};

use super::random::{between, normal, scale};

/// A record and the parameters from which it was made.
pub(crate) struct MadeRecord {
    pub(crate) truth: Parameters,
    pub(crate) dt: f64,
    pub(crate) samples: Vec<f64>,
}

/// A joint in the range of measured structures.
pub(crate) fn moderate(random: &mut SplitMix64, frequency: f64) -> Parameters {
    Parameters {
        frequency,
        damping_ratio: scale(random, 1e-4, 3e-3),
        k_t: (TAU * frequency).powi(2) * scale(random, 0.01, 0.3),
        f_s: scale(random, 10.0, 1000.0),
        chi: between(random, -0.9, 0.0),
        beta: scale(random, 0.02, 3.0),
    }
}

/// Acceleration after a release from rest at a given displacement.
pub(crate) fn ring_down(
    truth: &Parameters,
    displacement: f64,
    dt: f64,
    count: usize,
) -> Result<Vec<f64>, Error> {
    let (oscillator, joint) = truth.model()?;
    let mut out: [Vec<f64>; 4] = std::array::from_fn(|_| vec![0.0; count]);
    let stack = vec![Reversal::default(); (3.0 * count as f64 * dt * truth.frequency) as usize + 64];
    let [displacements, velocity, acceleration, joint_force] = &mut out;
    Decay::new(&oscillator, &joint, 0.0, Motion::held_at(displacement), stack)?
        .sample(dt, &mut Samples { displacement: displacements, velocity, acceleration, joint_force })?;
    let [_, _, acceleration, _] = out;
    Ok(acceleration)
}

pub(crate) fn phi_max(truth: &Parameters) -> Result<f64, Error> {
    Ok(truth.model()?.1.phi_max())
}

/// Adds noise with a root mean square of `decibels` below that of the samples; none for infinitely many decibels.
pub(crate) fn add_noise(samples: &mut [f64], decibels: f64, random: &mut SplitMix64) {
    if decibels.is_finite() {
        let mean_square = samples.iter().map(|x| x * x).sum::<f64>() / samples.len() as f64;
        let deviation = mean_square.sqrt() * 10.0_f64.powf(-decibels / 20.0);
        for x in samples {
            *x += deviation * normal(random);
        }
    }
}

/// A joint of 1 to 30 % of the stiffness, released at 0.1 to 2 φ_max, 40 to 400 cycles, in noise of `decibels` below the record's root mean
/// square.
pub(crate) fn in_noise(seed: u64, decibels: f64) -> Result<MadeRecord, Error> {
    let mut random = SplitMix64::new(5000 + seed);
    let frequency = scale(&mut random, 20.0, 1000.0);
    let truth = moderate(&mut random, frequency);
    let (per_cycle, cycles) = (scale(&mut random, 10.0, 60.0), scale(&mut random, 40.0, 400.0));
    let dt = 1.0 / (frequency * per_cycle);
    let start = scale(&mut random, 0.1, 2.0);
    let mut samples = ring_down(&truth, start * phi_max(&truth)?, dt, (cycles * per_cycle) as usize)?;
    add_noise(&mut samples, decibels, &mut random);
    Ok(MadeRecord { truth, dt, samples })
}
