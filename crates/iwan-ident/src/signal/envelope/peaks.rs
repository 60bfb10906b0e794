//! Peaks and zero crossings: amplitude from interpolated peaks, phase from interpolated crossings (Eq. 6-8).

use std::f64::consts::{PI, TAU};

use super::super::extrema::{crossings, extrema};
use super::super::isolated::{Isolated, Stretch};
use super::traces::Trace;
use crate::error::{Error, check_per_cycle};

/// Samples per cycle below which methods that look for peaks are refused: with eight, a zero crossing by a straight line is
/// off by 0.13 % of a cycle at worst, with six by 0.3 %, with four by 1.1 % (a sinusoid, worst place of the samples).
const PER_CYCLE: f64 = 8.0;

/// Refuses records with too few samples per cycle.
pub(super) fn check_rate(mode: &Isolated) -> Result<(), Error> {
    let per_cycle = 1.0 / (mode.band.peak * mode.dt);
    let allowed = format!("at least {PER_CYCLE} for methods that look for peaks");
    let remedy = "use the method `hilbert`, or sample faster";
    check_per_cycle(per_cycle, PER_CYCLE, &allowed, remedy).map(|_| ())
}

/// Logarithms of the interpolated peaks in the trusted window.
pub(super) fn peak_amplitudes(mode: &Isolated) -> Result<Trace, Error> {
    check_rate(mode)?;
    let Stretch { first, samples: x } = mode.stretch();
    let peaks = extrema(x, TAU * mode.band.peak * mode.dt);
    Ok(peaks.iter().map(|peak| ((first as f64 + peak.time) * mode.dt, peak.height.ln())).collect())
}

/// Phase (rad) at the zero crossings, less that of the reference frequency: each crossing is half a turn after the one before.
pub(super) fn crossing_phases(mode: &Isolated) -> Trace {
    let Stretch { first, samples: x } = mode.stretch();
    let times: Vec<f64> = crossings(x).iter().map(|n| (first as f64 + n) * mode.dt).collect();
    half_turns(&times, mode.band.peak)
}

/// Phase k π - 2π f t (rad) at `times` (s) that are half a cycle apart. Where noise makes three crossings out of one, k is the nearest
/// count of half turns.
pub(super) fn half_turns(times: &[f64], frequency: f64) -> Trace {
    let mut trace = Trace::default();
    let (mut turns, mut last) = (0.0, times.first().copied().unwrap_or(0.0));
    for &t in times {
        turns += (2.0 * frequency * (t - last)).round();
        last = t;
        trace.push(t, turns * PI - TAU * frequency * t);
    }
    trace
}
