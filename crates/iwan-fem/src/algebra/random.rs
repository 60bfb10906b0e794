//! Random numbers for probes of factors and for directions of a search.

use iwan_core::SplitMix64;

/// Random numbers in [-1, 1) from a seed, the same on every machine.
pub(crate) fn random(count: usize, seed: u64) -> Vec<f64> {
    let mut numbers = SplitMix64::new(seed);
    (0..count).map(|_| numbers.next_symmetric()).collect()
}
