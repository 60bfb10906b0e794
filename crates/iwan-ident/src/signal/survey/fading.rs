//! Windows that lie over a record: its noise fades with time as the window does, where measured noise goes on as it is.

use super::tapered::{LOBE, Tapered, kaiser};
use crate::signal::spectrum::median;

/// Number of parts of the record in which the noise is compared.
const PARTS: usize = 8;
/// Number of bands of the spectrum, of equal width, and the least number of lines of all.
const BANDS: usize = 6;
const LEAST: usize = 48;
/// Up to this fraction of the sampling rate a converter's own filter lets everything through.
const LEVEL: f64 = 0.38;
/// Least variance of the noise over the square of the largest sample: less is rounding, which follows the samples.
const NOISE: f64 = 1e-10;
/// The noise misses a window by at most this much (standard deviation of ln power), apart from three standard deviations of a mean of medians.
const MISSES: f64 = 0.25;
/// Standard deviation of ln of the median of `n` lines, times √n; under the window each line is correlated with its neighbours as if there were 1.8 times fewer.
const SCATTER: f64 = 1.44;
const ALIKE: f64 = 1.8;
/// An exponential window is told where the noise's power falls by at least this much in natural logarithms from the first part to the last, ...
const FALLS: f64 = 3.0;
/// ... misses a straight line by at most this part of its fall, differs in its fall from band to band by at most this part of it, ...
const STRAIGHT: f64 = 0.1;
const BANDED: f64 = 0.25;
/// ... falls in either half of the record by at least this part of the whole's rate, ...
const HALF: f64 = 0.7;
/// ... and falls by at most this part of what the mode's power falls by: noise of rounding follows the mode.
const SLOWER: f64 = 0.93;
/// Another window is told where the noise's changes with time exceed what it misses them by this factor.
const FOLLOWED: f64 = 3.0;

/// Ends of the octaves, as parts of the record, in which it is looked at how a record begins and ends, and the least number of cycles in the shortest of them.
const OCTAVES: [f64; 4] = [0.02, 0.04, 0.08, 0.16];
const CYCLES: f64 = 1.5;
/// A Hann window begins and ends with the square of time, 4 an octave. A decay under it rises less and falls more: the mean of both lies between these values, and each is at least so
/// much. Beats begin and end with time itself, 2 an octave.
const SQUARE: (f64, f64) = (3.0, 5.0);
const EACH: f64 = 1.6;

/// A window over a record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Window {
    /// exp(-t/τ), τ in s.
    Exponential(f64),
    Hann,
    Hamming,
}

/// ln of the noise's power in parts of a record, and of the mode's.
struct Noise {
    /// Middles of the parts, as parts of the record.
    at: Vec<f64>,
    /// `bands[part][band]`
    bands: Vec<[f64; BANDS]>,
    mode: Vec<f64>,
    /// Standard deviation of a mean over the bands.
    deviation: f64,
}

/// The window that lies over a record with a mode at `peak` Hz, where its noise tells one. The blow makes one part of the first half louder: where the noise of the others fits a
/// window, it is left out.
pub(super) fn window(x: &[f64], dt: f64, peak: f64) -> Option<Window> {
    if vanishes(x, peak * dt) {
        return Some(Window::Hann);
    }
    let noise = Noise::of(x, dt, peak)?;
    let left_out = std::iter::once(None).chain((0..PARTS / 2).map(Some));
    let length = x.len() as f64 * dt;
    left_out.map(|part| noise.without(part)).find_map(|noise| noise.window(length))
}

/// Whether everything in a record begins from zero and ends at zero as under a Hann window; `per_sample` is the number of cycles of the mode in a sample.
fn vanishes(x: &[f64], per_sample: f64) -> bool {
    let at = OCTAVES.map(|part| (part * x.len() as f64) as usize);
    let largest = |part: &[f64]| part.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    let from_begin = |i: usize| largest(&x[at[i]..at[i + 1]]);
    let from_end = |i: usize| largest(&x[x.len() - at[i + 1]..x.len() - at[i]]);
    let is_square = |i: usize| {
        let rises = [from_begin(i + 1) / from_begin(i), from_end(i + 1) / from_end(i)];
        let mean = (rises[0] * rises[1]).sqrt();
        mean > SQUARE.0 && mean < SQUARE.1 && rises.iter().all(|rise| *rise > EACH)
    };
    (at[1] - at[0]) as f64 * per_sample >= CYCLES && (0..OCTAVES.len() - 2).all(is_square)
}

impl Noise {
    fn of(x: &[f64], dt: f64, peak: f64) -> Option<Self> {
        let parts: Vec<Tapered> =
            x.chunks_exact((x.len() / PARTS).max(2)).take(PARTS).map(|x| Tapered::new(x, dt)).collect();
        let step = parts.first()?.step;
        let (from, to) = ((2.0 * LOBE) as usize, ((LEVEL / dt / step) as usize).min(parts[0].power.len()));
        let count = to.checked_sub(from).filter(|count| *count >= LEAST)? / BANDS;
        let band = |part: &Tapered, n: usize| {
            let lines = part.power[from + n * count..from + (n + 1) * count].to_vec();
            // The median of the power of a line of noise is ln 2 times its mean.
            (median(lines) / std::f64::consts::LN_2).max(f64::MIN_POSITIVE).ln()
        };
        let bands: Vec<[f64; BANDS]> =
            parts.iter().map(|part| std::array::from_fn(|n| band(part, n))).collect();
        let near = ((peak / step - LOBE).max(0.0) as usize)..((peak / step + LOBE) as usize + 1).min(to);
        let mode = |part: &Tapered| part.power[near.clone()].iter().sum::<f64>().max(f64::MIN_POSITIVE).ln();
        let mean = x.iter().sum::<f64>() / x.len() as f64;
        let largest = x.iter().map(|x| (x - mean).powi(2)).fold(0.0, f64::max);
        let level = |n: usize| bands.iter().map(|b| b[n].exp()).sum::<f64>() / PARTS as f64;
        let variance = median((0..BANDS).map(level).collect());
        (variance > NOISE * largest).then(|| Self {
            at: (0..PARTS).map(|i| (i as f64 + 0.5) / PARTS as f64).collect(),
            mode: parts.iter().map(mode).collect(),
            bands,
            deviation: SCATTER * (ALIKE / (count * BANDS) as f64).sqrt(),
        })
    }

    fn without(&self, part: Option<usize>) -> Self {
        let kept = |i: &usize| Some(*i) != part;
        let all = || (0..PARTS).filter(kept);
        Self {
            at: all().map(|i| self.at[i]).collect(),
            bands: all().map(|i| self.bands[i]).collect(),
            mode: all().map(|i| self.mode[i]).collect(),
            deviation: self.deviation,
        }
    }

    /// The window that fits, over a record of `length` seconds.
    fn window(&self, length: f64) -> Option<Window> {
        let means: Vec<f64> = self.bands.iter().map(|b| b.iter().sum::<f64>() / BANDS as f64).collect();
        let allowed = MISSES + 3.0 * self.deviation;
        let varies = deviation(&means);
        let cosine = |mean: f64| {
            let expected = self.at.iter().map(|at| cosine_in(*at, mean));
            let missed: Vec<f64> = means.iter().zip(expected).map(|(m, e)| m - e).collect();
            let missed = deviation(&missed);
            missed < allowed && varies > FOLLOWED * missed
        };
        if cosine(0.5) {
            return Some(Window::Hann);
        }
        if cosine(HAMMING) {
            return Some(Window::Hamming);
        }
        let whole = 0..self.at.len();
        let half = self.at.iter().position(|at| *at > 0.5)?;
        let rate = |y: &[f64], range: std::ops::Range<usize>| -slope(&self.at[range.clone()], &y[range]);
        let fall = rate(&means, whole.clone());
        let missed: Vec<f64> = means.iter().zip(&self.at).map(|(m, at)| m + fall * at).collect();
        let missed = deviation(&missed);
        let of_bands: Vec<f64> = (0..BANDS)
            .map(|n| rate(&self.bands.iter().map(|b| b[n]).collect::<Vec<_>>(), whole.clone()))
            .collect();
        let apart = of_bands.iter().fold(f64::NEG_INFINITY, |m, v| m.max(*v))
            - of_bands.iter().fold(f64::INFINITY, |m, v| m.min(*v));
        let is_straight = missed < allowed.min(STRAIGHT * fall)
            && [0..half, half..self.at.len()].into_iter().all(|part| rate(&means, part) > HALF * fall);
        // The slope over a record of seven or eight parts scatters by about as much as a mean, and that of one band by √6 times as much.
        let is_one = apart < BANDED * fall + 6.0 * self.deviation * (BANDS as f64).sqrt();
        let is_slower = fall < SLOWER * rate(&self.mode, whole);
        (fall * (1.0 - 1.0 / PARTS as f64) > FALLS && is_straight && is_one && is_slower)
            .then_some(Window::Exponential(2.0 * length / fall))
    }
}

/// Hamming's window is 0.54 - 0.46 cos, Hann's 0.5 - 0.5 cos.
const HAMMING: f64 = 0.54;

/// ln of the mean power that the window `mean` - (1 - `mean`) cos leaves in the part about `at`.
fn cosine_in(at: f64, mean: f64) -> f64 {
    const NODES: usize = 50;
    let value = |i: usize| {
        let place = 2.0 * (i as f64 + 0.5) / NODES as f64 - 1.0;
        let turn = std::f64::consts::TAU * (at + 0.5 * place / PARTS as f64);
        let weight = kaiser(place).powi(2);
        (weight * (mean - (1.0 - mean) * turn.cos()).powi(2), weight)
    };
    let (sum, weight) = (0..NODES).map(value).fold((0.0, 0.0), |a, b| (a.0 + b.0, a.1 + b.1));
    (sum / weight).ln()
}

fn deviation(y: &[f64]) -> f64 {
    let mean = y.iter().sum::<f64>() / y.len() as f64;
    (y.iter().map(|y| (y - mean).powi(2)).sum::<f64>() / y.len() as f64).sqrt()
}

/// Slope of the straight line through values at two places or more.
fn slope(x: &[f64], y: &[f64]) -> f64 {
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
    let (a, b) = (mean(x), mean(y));
    let moment = x.iter().zip(y).map(|(x, y)| (x - a) * (y - b)).sum::<f64>();
    moment / x.iter().map(|x| (x - a).powi(2)).sum::<f64>()
}
