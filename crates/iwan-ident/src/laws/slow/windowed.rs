//! A ring-down as the slow flow sees it: complex amplitudes in overlapping windows, with independent noise of equal variance.
//!
//! z_k = ∫ w(t - kH) x(t) e^(-iθ(t)) dt with w = sin⁴(πt/4H) on 0 … 4H, as in [`refine`](mod@crate::refine), but with the
//! measured phase θ in place of a fixed frequency: a mode that softens by a third stays in the middle of its windows.

use std::f64::consts::{PI, TAU};

use rustfft::num_complex::Complex64;

use crate::curves::Curves;
use crate::error::Error;
use crate::refine::{OVERLAP, RingDown, Whitening};

/// Moments, from window to window, at which the slow motion is taken: the sum over a window is then its integral to rounding, as long as the phase
/// strays by less than six turns over the window.
pub(crate) const PER_HOP: usize = 4;
/// Most windows of a record: more say no more about a slow amplitude, and cost time. Longer records have longer windows.
const MOST: f64 = 120.0;
/// Fewest windows: amplitude and phase at five places. Shorter records are refused.
const FEWEST: usize = 5;
/// Ratio of the amplitudes of successive windows below which the mode has stopped: linear decays with 10 % of damping leave half of the amplitude.
const STOPPED: f64 = 0.3;
/// Least amplitude of a window over the noise. Below it a mode under dry friction may have stopped, which averaging does not know, and what a viscous
/// decay would tell further about its damping is a per cent of what it told before. A judgement.
const ABOVE_NOISE: f64 = 5.0;

/// A ring-down, with the curves that its envelope gave.
#[derive(Debug, Clone, Copy)]
pub struct Source<'a> {
    /// The ring-down: samples in free decay.
    pub ring_down: RingDown<'a>,
    /// Time of the first sample on the time axis of the curves, s.
    pub first: f64,
    /// Frequency and damping of the envelope against time.
    pub curves: &'a Curves,
}

/// Complex amplitudes of a record in windows.
#[derive(Debug, Clone)]
pub(crate) struct Windowed {
    /// Time between the moments at which the slow motion is taken, s.
    pub(crate) step: f64,
    /// Reference phase at these moments, rad.
    pub(crate) phase: Vec<f64>,
    count: usize,
    whitening: Whitening,
    /// Magnitudes of the amplitudes before whitening, over the standard deviation that noise of variance one makes.
    loudness: Vec<f64>,
    /// Whitened amplitudes: real and imaginary part of each window, one after the other.
    pub(crate) values: Vec<f64>,
    /// Number of times that the displacement was differentiated.
    pub(crate) power: i32,
}

impl Windowed {
    pub(crate) fn new(source: &Source<'_>) -> Result<Self, Error> {
        let RingDown { samples, dt, quantity, band, .. } = source.ring_down;
        let curves = source.curves;
        let frequency = curves.frequency.iter().sum::<f64>() / curves.frequency.len().max(1) as f64;
        let seconds = (samples.len().max(1) - 1) as f64 * dt;
        let least = band.map_or(1.0, |band| 1.5 * frequency / band);
        let cycles = least.max(seconds * frequency / MOST).max(1.0);
        let hop = cycles / frequency;
        let count = ((seconds / hop + 1e-9) as usize + 1).saturating_sub(OVERLAP);
        if count < FEWEST {
            let found = (seconds * frequency) as usize;
            let remedy = "record longer or louder";
            let needed = ((FEWEST + OVERLAP) as f64 * cycles).ceil() as usize;
            return Err(Error::TooShort {
                what: "cycles in free decay, to compare laws",
                found,
                needed,
                remedy,
            });
        }
        let step = hop / PER_HOP as f64;
        let nodes = (count + OVERLAP - 1) * PER_HOP + 1;
        let omega: Vec<f64> =
            (0..nodes).map(|j| TAU * frequency_at(curves, source.first + j as f64 * step)).collect();
        let mut phase = vec![0.0; nodes];
        for j in 1..nodes {
            phase[j] = phase[j - 1] + 0.5 * step * (omega[j - 1] + omega[j]);
        }
        let (whitening, power) = (Whitening::of(count, hop), quantity.power());
        let mut windowed = Self { step, phase, count, whitening, loudness: vec![], values: vec![], power };
        let amplitudes = windowed.of_samples(samples, dt, &omega);
        let own = windowed.whitening.of_noise();
        windowed.loudness = amplitudes.iter().map(|z| z.norm() / own).collect();
        windowed.values = windowed.whitened(amplitudes);
        windowed.cut_at(windowed.stops());
        Ok(windowed)
    }

    /// Index of the first window in which the mode has come to rest, as under dry friction; the number of windows if there is none.
    fn stops(&self) -> usize {
        let stops = |pair: &[f64]| pair[1] < STOPPED * pair[0];
        self.loudness.windows(2).position(stops).map_or(self.count, |k| k + 1)
    }

    /// Leaves out windows that are not louder than `ABOVE_NOISE` times the `noise`, a standard deviation of whitened values. True if any were left
    /// out.
    pub(crate) fn cut_at_noise(&mut self, noise: f64) -> bool {
        let quiet = self.loudness.iter().position(|l| *l < ABOVE_NOISE * noise).unwrap_or(self.count);
        self.cut_at(quiet)
    }

    /// Keeps the windows that end before window `quiet` begins, and at least `FEWEST`. True if any were left out.
    fn cut_at(&mut self, quiet: usize) -> bool {
        let count =
            if quiet < self.count { (quiet + 1).saturating_sub(OVERLAP).max(FEWEST) } else { self.count };
        let cut = count < self.count;
        self.count = count.min(self.count);
        self.loudness.truncate(self.count);
        self.values.truncate(2 * self.count);
        self.phase.truncate((self.count + OVERLAP - 1) * PER_HOP + 1);
        cut
    }

    /// Complex amplitudes of uniform samples from t = 0, less their mean, one per window; `omega` is the reference frequency at the moments, rad/s.
    fn of_samples(&self, samples: &[f64], dt: f64, omega: &[f64]) -> Vec<Complex64> {
        let mean = samples.iter().sum::<f64>() / samples.len() as f64;
        let mut out = vec![Complex64::default(); self.count];
        let hop = self.step * PER_HOP as f64;
        for (n, x) in samples.iter().enumerate() {
            let t = n as f64 * dt;
            let j = (t / self.step) as usize;
            if j + 1 >= omega.len() {
                break;
            }
            let s = t - j as f64 * self.step;
            let bend = 0.5 * (omega[j + 1] - omega[j]) / self.step;
            let phase = self.phase[j] + s * (omega[j] + bend * s);
            let turned = Complex64::cis(-phase.rem_euclid(TAU)) * ((x - mean) * dt);
            let last = (t / hop) as usize;
            let covering = last.saturating_sub(OVERLAP - 1)..(last + 1).min(self.count);
            for (k, out) in out.iter_mut().enumerate().take(covering.end).skip(covering.start) {
                *out += turned * (0.25 * PI * (t / hop - k as f64)).sin().powi(4);
            }
        }
        out
    }

    /// Whitened amplitudes of a slow motion, which is given by half its complex amplitude, less the reference phase, at each moment.
    pub(crate) fn of_motion(&self, slow: &[Complex64]) -> Vec<f64> {
        const WIDE: usize = OVERLAP * PER_HOP;
        let weight: [f64; WIDE] =
            std::array::from_fn(|m| self.step * (PI * m as f64 / WIDE as f64).sin().powi(4));
        let window = |k: usize| {
            weight.iter().zip(&slow[k * PER_HOP..]).fold(Complex64::default(), |sum, (w, z)| sum + z * *w)
        };
        self.whitened((0..self.count).map(window).collect())
    }

    fn whitened(&self, mut z: Vec<Complex64>) -> Vec<f64> {
        self.whitening.apply(&mut z);
        z.iter().flat_map(|z| [z.re, z.im]).collect()
    }
}

/// Frequency of curves at a time, Hz: straight lines between their entries, the first or last value beyond.
fn frequency_at(curves: &Curves, t: f64) -> f64 {
    let next = curves.t.partition_point(|s| *s <= t);
    if next == 0 || next == curves.t.len() {
        return curves.frequency[next.saturating_sub(1).min(curves.frequency.len() - 1)];
    }
    let s = (t - curves.t[next - 1]) / (curves.t[next] - curves.t[next - 1]);
    curves.frequency[next - 1] + s * (curves.frequency[next] - curves.frequency[next - 1])
}
