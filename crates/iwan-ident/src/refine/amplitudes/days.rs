//! The frequency of the day: hits of one specimen differ by what temperature and mounting do to its stiffness.
//!
//! Each of several records has an unknown of its own, δ = ln(ω/ω0) at small amplitude, whose scatter from hit to hit is estimated with the rest
//! ([`sizes`](crate::refine::sizes)). Parameters are those of the mean of all days. K_∞ carries the difference: ω(a) = √(K_∞ + K_1(a)) then moves by δ ω0²/ω(a), and the
//! phase of a ring-down by the integral of that over time.

use rustfft::num_complex::Complex64;

use super::windows::{OVERLAP, Windows};
use crate::student::{NORMAL, student};

/// What hits stray by before anything is known, relative: a third of a per cent, which ten kelvin and a bolted joint that is put together anew do not pass.
pub(in crate::refine) const FIRST: f64 = 3e-3;
/// Least scatter that is taken for granted: ring-downs of real structures do not repeat better, and simulated ones lose nothing by it.
pub(in crate::refine) const LEAST: f64 = 1e-5;

/// Records of which the loudest begins so many times as loud as the softest are of different levels: hits that are meant to be repeats differ by less, levels of
/// a test by more. A judgement.
pub(in crate::refine) const LEVEL: f64 = 1.25;

/// Whether records that begin with such amplitudes may differ by the day. Of two levels with one record each what differs may as well be the level: other modes that
/// ring with a hard blow, and softening that the law tells wrongly, would be taken for a day.
pub(crate) fn may_stray(amplitudes: &[f64]) -> bool {
    match *amplitudes {
        [] | [_] => false,
        [a, b] => (a / b).ln().abs() < LEVEL.ln(),
        _ => true,
    }
}

/// A standard deviation that was estimated from so many records, as one that is known would have to be for an interval of the mean to hold 95 %: Student's quantile over the
/// normal one.
pub(in crate::refine) fn of_few(deviation: f64, records: usize) -> f64 {
    deviation * student(records as f64 - 1.0) / NORMAL
}

/// Turns a model's amplitudes in windows by the phase that a day's frequency adds; `omega0` is that of the mean of all days, rad/s.
pub(in crate::refine) fn turn(model: &mut [Complex64], windows: &Windows, omega0: f64, day: f64) {
    if day == 0.0 {
        return;
    }
    // From the first sample to the middle of the first window.
    let first = 0.5 * OVERLAP as f64 * windows.hop;
    let (mut phase, mut before) = (day * omega0 * first, None::<Complex64>);
    for z in model {
        if let Some(before) = before {
            let omega = windows.omega + (*z / before).arg() / windows.hop;
            phase += day * omega0 * omega0 / omega * windows.hop;
        }
        before = Some(*z);
        *z *= Complex64::cis(phase);
    }
}
