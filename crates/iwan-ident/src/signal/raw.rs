//! Amplitude and phase of a mode from its analytic signal, before smoothing.

use std::ops::Range;

use super::extrema::extrema;
use super::hilbert::{analytic_signal, whole_cycles};
use crate::smooth::{Points, Polynomial};

/// Points per cycle that are kept. The automatic band is 0.55 of the frequency wide, so that four points a cycle are seven times as many as the signal has
/// independent values. Two and eight change the damping within its scatter.
const PER_CYCLE: f64 = 4.0;
/// Cycles trimmed at each end after the cut to whole cycles: there the analytic signal of a finite record is wrong by a few per
/// cent, less with every cycle.
const TRIMMED: f64 = 1.5;
/// Cycles by which the transformed stretch reaches beyond the window where the record has them: one for the cut to whole cycles, one
/// and a half for the trimming, and some to spare.
pub(super) const BEYOND: f64 = 3.0;
/// Highest degree of the curve that flattens the record before the transform: the flattened record only needs to be flat enough to be periodic. Degrees one,
/// three and ten give the same damping within 0.3 % on the Brake-Reuss record.
const FLATTENING: usize = 5;

/// Log amplitude and phase (rad, less the phase of the reference frequency) at uniform times (s).
#[derive(Debug, Clone, Default)]
pub(crate) struct Raw {
    pub(crate) t: Vec<f64>,
    pub(crate) log_amplitude: Vec<f64>,
    pub(crate) phase: Vec<f64>,
}

/// Log amplitude and phase by the Hilbert transform of the samples in `window`; `centre` is the reference frequency in Hz.
///
/// Before the transform the samples are divided by a smooth curve through their peaks (by Bedrosian's theorem a slow
/// factor passes the transform unchanged) and cut to whole cycles: the periodic continuation then has neither a jump in
/// amplitude nor in phase, and the ends are wrong for about a cycle only. These are trimmed. Empty when there are fewer
/// than four peaks.
pub(crate) fn raw(samples: &[f64], window: &Range<usize>, dt: f64, centre: f64) -> Raw {
    let outer = widened(window, samples.len(), BEYOND / (centre * dt));
    let x = &samples[outer.clone()];
    let omega = std::f64::consts::TAU * centre * dt;
    let peaks = extrema(x, omega);
    if peaks.len() < 4 {
        return Raw::default();
    }
    let (t, log): (Vec<f64>, Vec<f64>) = peaks.iter().map(|peak| (peak.time, peak.height.ln())).unzip();
    let points = Points { t: &t, y: &log, weight: &vec![1.0; t.len()], effective: 0.5 * t.len() as f64 };
    let curve = Polynomial::fit(&points, None, FLATTENING.min(t.len() / 4));
    // Beyond the first and the last peak a polynomial may run away.
    let level = |n: usize| curve.value((n as f64).clamp(t[0], t[t.len() - 1]));
    let flat: Vec<f64> = (0..x.len()).map(|n| x[n] / level(n).exp()).collect();
    let Some(cut) = whole_cycles(&flat) else { return Raw::default() };
    let Ok(analytic) = analytic_signal(&flat[cut.clone()]) else { return Raw::default() };
    let step = (1.0 / (PER_CYCLE * centre * dt)).max(1.0) as usize;
    let trim = (TRIMMED / (centre * dt)).ceil() as usize;
    let mut raw = Raw::default();
    for i in (trim..analytic.len().saturating_sub(trim)).step_by(step) {
        let n = cut.start + i;
        if !window.contains(&(outer.start + n)) {
            continue;
        }
        let turns = (outer.start + n) as f64 * dt * centre;
        let mut phase = analytic[i].arg() - std::f64::consts::TAU * turns.fract();
        let last = raw.phase.last().copied().unwrap_or(0.0);
        phase -= std::f64::consts::TAU * ((phase - last) / std::f64::consts::TAU).round();
        raw.t.push((outer.start + n) as f64 * dt);
        raw.log_amplitude.push(analytic[i].norm().max(f64::MIN_POSITIVE).ln() + level(n));
        raw.phase.push(phase);
    }
    raw
}

/// A window widened by `by` samples on either side, within a record of `samples` samples.
pub(crate) fn widened(window: &Range<usize>, samples: usize, by: f64) -> Range<usize> {
    let by = by.ceil() as usize;
    window.start.saturating_sub(by)..(window.end + by).min(samples)
}
