//! Random numbers for tests and statistics.

use std::f64::consts::TAU;

use iwan_core::SplitMix64;

/// A uniform number between 0 and 1.
pub(crate) fn uniform(random: &mut SplitMix64) -> f64 {
    0.5 + 0.5 * random.next_symmetric()
}

/// A normally distributed number of variance 1 (Box and Muller).
pub(crate) fn normal(random: &mut SplitMix64) -> f64 {
    let radius = (-2.0 * uniform(random).max(f64::MIN_POSITIVE).ln()).sqrt();
    radius * (TAU * uniform(random)).cos()
}

pub(crate) fn between(random: &mut SplitMix64, low: f64, high: f64) -> f64 {
    low + (high - low) * uniform(random)
}

/// A number whose logarithm is uniformly distributed.
pub(crate) fn scale(random: &mut SplitMix64, low: f64, high: f64) -> f64 {
    between(random, low.ln(), high.ln()).exp()
}
