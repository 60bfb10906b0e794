//! What is compared of a record: weighted sums over its samples ("entries"), orthonormal, so that white noise keeps its standard deviation.

use std::f64::consts::{PI, TAU};

use super::between::{at_samples, in_blocks};

/// Number of entries in a period of the fastest mode where samples are averaged: 12 lose 1 % of its amplitude.
const ENTRIES_A_PERIOD: f64 = 12.0;
/// Length of a window about a mode's frequency, in periods of the mode: over 8 the amplitude of a mode with 1 % damping falls to no less than about a half.
const PERIODS: f64 = 8.0;
/// A window is at least this many periods of the difference frequency of neighbouring modes long, so that it sees its own mode alone: the main lobe of
/// Hann's window ends at 2.
const APART: f64 = 4.0;

/// How a series of samples becomes entries.
#[derive(Debug, Clone)]
pub enum Sums {
    /// Each entry sums this many successive samples.
    Blocks(usize),
    /// Entries come in pairs: samples times cosine and sine of a frequency, summed in Hann windows that overlap by half.
    Windows {
        /// Phase advance from sample to sample, rad: circular frequency times sampling interval.
        turn: f64,
        /// Number of samples of a window.
        length: usize,
    },
}

impl Sums {
    /// Sums for a forced record, in which all motion counts; `fastest` is the highest frequency of a mode, Hz.
    #[must_use]
    pub fn of_forced(dt: f64, fastest: f64) -> Self {
        Self::Blocks(((1.0 / (dt * fastest * ENTRIES_A_PERIOD)).floor() as usize).max(1))
    }

    /// Sums for a free decay, about the frequency of the mode `index`; frequencies in Hz.
    #[must_use]
    pub fn of_free(dt: f64, frequencies: &[f64], index: usize) -> Self {
        let own = frequencies[index];
        let others = frequencies.iter().enumerate().filter(|(i, _)| *i != index);
        let nearest = others.map(|(_, f)| (f - own).abs()).fold(f64::INFINITY, f64::min);
        let length = (PERIODS / own).max(APART / nearest) / dt;
        Self::Windows { turn: TAU * own * dt, length: (length.round() as usize).max(8) }
    }

    /// Number of entries that this many samples make.
    #[must_use]
    pub fn count(&self, samples: usize) -> usize {
        match self {
            Self::Blocks(block) => samples / block,
            Self::Windows { length, .. } if samples < *length => 0,
            Self::Windows { length, .. } => 2 * ((samples - length) / (length / 2) + 1),
        }
    }

    /// Number of entries of one window: two, cosine and sine, or one for a block.
    #[must_use]
    pub const fn parts(&self) -> usize {
        if matches!(self, Self::Windows { .. }) { 2 } else { 1 }
    }

    /// Number of samples that an entry is made of.
    #[must_use]
    pub const fn length(&self) -> usize {
        match self {
            Self::Blocks(length) | Self::Windows { length, .. } => *length,
        }
    }

    /// Fills `out` with the entries of `samples` samples that are known at every so-manyth of them (`rows`).
    pub(in crate::coupled) fn of_rows(
        &self,
        (rows, every): (&[f64], usize),
        samples: usize,
        out: &mut [f64],
    ) {
        match self {
            _ if every == 1 => self.apply(&rows[..samples], out),
            Self::Blocks(block) => {
                in_blocks(rows, every, *block, out);
                let scale = (*block as f64).sqrt().recip();
                for sum in out.iter_mut() {
                    *sum *= scale;
                }
            }
            Self::Windows { .. } => self.apply(&at_samples(rows, every, samples), out),
        }
    }

    /// Fills `out` with the entries of the samples.
    pub fn apply(&self, samples: &[f64], out: &mut [f64]) {
        match self {
            Self::Blocks(block) => {
                let scale = (*block as f64).sqrt().recip();
                for (out, block) in out.iter_mut().zip(samples.chunks_exact(*block)) {
                    *out = scale * block.iter().sum::<f64>();
                }
            }
            Self::Windows { turn, length } => {
                let weights = hann(*length);
                for (n, pair) in out.chunks_exact_mut(2).enumerate() {
                    let z = turned(samples, n * (length / 2), &weights, *turn);
                    pair.copy_from_slice(&z);
                }
            }
        }
    }
}

/// Hann's window of `length` samples.
fn hann(length: usize) -> Vec<f64> {
    (0..length).map(|n| (PI * (n as f64 + 0.5) / length as f64).sin().powi(2)).collect()
}

/// Amplitude (cosine and sine part, with the phase of the first sample of the record) in a window that begins at sample `first`: about √(length/3) times that of a sinusoid.
fn turned(samples: &[f64], first: usize, weights: &[f64], turn: f64) -> [f64; 2] {
    let (mut sums, mut square) = ([0.0; 2], 0.0);
    // Cosine and sine by rotation, begun anew in every window: rounding grows by one unit a sample.
    let (mut at, step) = ((turn * first as f64).sin_cos(), turn.sin_cos());
    for (weight, x) in weights.iter().zip(&samples[first..first + weights.len()]) {
        sums[0] += weight * x * at.1;
        sums[1] += weight * x * at.0;
        square += weight * weight;
        at = (at.0 * step.1 + at.1 * step.0, at.1 * step.1 - at.0 * step.0);
    }
    let scale = (2.0 / square).sqrt();
    sums.map(|sum| scale * sum)
}

/// A complex amplitude at the first sample, real and imaginary part of x ≈ Re Z exp(iωt), over the first `length` samples.
pub(in crate::coupled) fn amplitude(samples: &[f64], length: usize, turn: f64) -> [f64; 2] {
    let length = length.min(samples.len());
    let [c, s] = turned(samples, 0, &hann(length), turn);
    // Σ w cos² = length/4 for Hann's window, and Σ w² = 3 length/8.
    let scale = (2.0 / (0.375 * length as f64)).sqrt() * 0.25 * length as f64;
    [c / scale, -s / scale]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_noise_keeps_its_deviation_and_a_sinusoid_its_amplitude() {
        let turn = 0.3;
        let x: Vec<f64> = (0..400).map(|n| 2.0 * (turn * f64::from(n) + 0.7).cos()).collect();
        let [re, im] = amplitude(&x, 400, turn);
        assert!((re.hypot(im) - 2.0).abs() < 1e-3 && (im.atan2(re) - 0.7).abs() < 1e-3);
        // The response to a unit impulse anywhere: the squares of all weights of an entry add up to one.
        let sums = Sums::Windows { turn, length: 100 };
        let mut square = 0.0;
        for n in 0..100 {
            let mut impulse = vec![0.0; 100];
            impulse[n] = 1.0;
            let mut out = [0.0; 2];
            sums.apply(&impulse, &mut out);
            square += out[0] * out[0] + out[1] * out[1];
        }
        assert!((square - 2.0).abs() < 1e-12, "{square}");
        assert_eq!((sums.count(99), sums.count(100), sums.count(150)), (0, 2, 4));
        assert_eq!(Sums::Blocks(3).count(10), 3);
    }
}
