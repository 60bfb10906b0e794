//! The frequency of the day: hits on one specimen differ because temperature and mounting change its stiffness.
//!
//! Each of several records has an unknown of its own, the day δ = ln(ω/ω0): the record's frequency at small amplitude over that of the mean of all
//! days. The scatter of δ from hit to hit is estimated beside the fit ([`discrepancy`](crate::refine::discrepancy)). Parameters are those of the mean
//! of all days. K_∞ carries the difference: ω(a) = √(K_∞ + K_1(a)) then moves by δ ω0²/ω(a), and the phase of a ring-down by the integral of this
//! change over time.

use rustfft::num_complex::Complex64;

use super::windows::{OVERLAP, Windows};
use crate::student::{NORMAL, student};

/// Standard deviation of δ from hit to hit that the first search takes for granted: a third of a per cent, which ten kelvin and a bolted joint that
/// is put together anew do not exceed.
pub(in crate::refine) const FIRST: f64 = 3e-3;
/// Least standard deviation of δ, to which a smaller estimate is raised: ring-downs of real structures do not repeat better, and simulated ones lose
/// nothing by it.
pub(in crate::refine) const LEAST: f64 = 1e-5;

/// Ratio of the first amplitudes of two records from which on they are of different levels of force: hits that are meant to be repeats differ by
/// less, levels of a test by more. A judgement.
pub(in crate::refine) const LEVEL: f64 = 1.25;

/// Whether records with these first `amplitudes` (one per record) may differ by the day. Two records of two levels may not: what differs between them
/// may as well be due to the level (other modes that ring with a hard blow, or softening that the law describes wrongly) and would be taken for a
/// day.
pub(crate) fn may_stray(amplitudes: &[f64]) -> bool {
    match *amplitudes {
        [] | [_] => false,
        [a, b] => (a / b).ln().abs() < LEVEL.ln(),
        _ => true,
    }
}

/// Widens a standard deviation that was estimated from few `records`, so that ±1.96 times the result is a 95 % interval of the mean as Student's
/// distribution gives it: the factor is Student's quantile over the normal one.
pub(in crate::refine) fn of_few(deviation: f64, records: usize) -> f64 {
    deviation * student(records as f64 - 1.0) / NORMAL
}

/// Turns a model's complex amplitudes in windows by the phase that a day's frequency adds. `day` is δ, `omega0` the frequency of the mean of all days
/// at small amplitude, rad/s.
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
