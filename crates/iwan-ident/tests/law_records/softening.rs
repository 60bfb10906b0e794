//! Ring-downs of random joints without noise, from modes that hardly soften to modes that lose half of their frequency.

use std::f64::consts::TAU;

use iwan_core::SplitMix64;
use iwan_ident::{Error, Parameters};

use super::in_noise::{MadeRecord, phi_max, ring_down};
use super::random::{between, scale};

/// A joint of 5 % to three times the residual stiffness, released at 0.2 to 4 φ_max, 20 to 500 cycles of 10 to 100 samples, without noise.
pub(crate) fn softening(seed: u64) -> Result<MadeRecord, Error> {
    let mut random = SplitMix64::new(1000 + seed);
    let frequency = scale(&mut random, 20.0, 1000.0);
    let ratio = scale(&mut random, 0.05, 3.0);
    let truth = Parameters {
        frequency,
        damping_ratio: scale(&mut random, 1e-4, 3e-3),
        k_t: (TAU * frequency).powi(2) * ratio / (1.0 + ratio),
        f_s: scale(&mut random, 10.0, 1000.0),
        chi: between(&mut random, -0.8, 0.0),
        beta: scale(&mut random, 0.02, 3.0),
    };
    let (start, cycles, per_cycle) =
        (scale(&mut random, 0.2, 4.0), scale(&mut random, 20.0, 500.0), scale(&mut random, 10.0, 100.0));
    let dt = 1.0 / (frequency * per_cycle);
    let samples = ring_down(&truth, start * phi_max(&truth)?, dt, (cycles * per_cycle) as usize)?;
    Ok(MadeRecord { truth, dt, samples })
}
