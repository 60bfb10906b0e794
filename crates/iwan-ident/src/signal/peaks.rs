//! Peaks and zero crossings: amplitude from interpolated peaks, phase from interpolated crossings (Eq. 6-8).

use std::f64::consts::{PI, TAU};

use super::extrema::{crossings, extrema};
use super::isolate::Isolated;
use crate::error::{Error, check};

/// Samples per cycle below which peaks between samples are not worth fitting: the crossings by straight lines would be
/// off by 0.3 % of a cycle.
const PER_CYCLE: f64 = 8.0;

/// Times (s) and values in two vectors.
pub(crate) type Trace = (Vec<f64>, Vec<f64>);

/// Refuses records with too few samples per cycle.
pub(crate) fn check_rate(mode: &Isolated) -> Result<(), Error> {
    let per_cycle = 1.0 / (mode.band.peak * mode.dt);
    let allowed = format!("at least {PER_CYCLE} for methods that look for peaks");
    let remedy = "use the method `hilbert`, or sample faster";
    check("samples per cycle", per_cycle, per_cycle >= PER_CYCLE, &allowed, remedy).map(|_| ())
}

/// Logarithms of the interpolated peaks in the trusted window.
pub(crate) fn peak_amplitudes(mode: &Isolated) -> Result<Trace, Error> {
    check_rate(mode)?;
    let (first, x) = mode.stretch();
    let peaks = extrema(x, TAU * mode.band.peak * mode.dt);
    Ok(peaks.iter().map(|(n, a)| ((first as f64 + n) * mode.dt, a.ln())).unzip())
}

/// Phase at the zero crossings, less that of the reference frequency: each crossing is half a turn on.
pub(crate) fn crossing_phases(mode: &Isolated) -> Trace {
    let (first, x) = mode.stretch();
    let times: Vec<f64> = crossings(x).iter().map(|n| (first as f64 + n) * mode.dt).collect();
    half_turns(&times, mode.band.peak)
}

/// Phase k π - 2π f t at times that are half a cycle apart. Where noise makes three crossings out of one, the nearest
/// count of half turns is taken.
pub(crate) fn half_turns(times: &[f64], frequency: f64) -> Trace {
    let mut trace: Trace = (vec![], vec![]);
    let (mut turns, mut last) = (0.0, times.first().copied().unwrap_or(0.0));
    for &t in times {
        turns += (2.0 * frequency * (t - last)).round();
        last = t;
        trace.0.push(t);
        trace.1.push(turns * PI - TAU * frequency * t);
    }
    trace
}
