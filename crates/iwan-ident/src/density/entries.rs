//! The entries of the curves to which the density is fitted.

use std::f64::consts::TAU;

use crate::curve_fit::{DISSIPATION_FLOOR, FREQUENCY_FLOOR};
use crate::curves::Curves;

/// Most entries of one curve that are used: a smooth curve holds a dozen independent values, and the time of the solution grows with the entries.
/// Longer curves are thinned.
const ENTRIES: usize = 150;
/// Part of a curve that is left out at either end, where smooth curves through records know one side only and are worst. A judgement.
const ENDS: f64 = 0.04;
/// Steepest slope d ln ω/d ln u that is believed; a steeper one is noise and counts as zero. A joint that makes up all stiffness in macro-slip
/// reaches -1/2, a joint of a tenth of it -0.05.
const STEEPEST: f64 = 0.3;

/// An entry of a curve.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entry {
    pub(super) displacement: f64,
    pub(super) dissipation: f64,
    pub(super) log_sd: f64,
    pub(super) omega: f64,
    pub(super) omega_sd: f64,
}

/// The usable entries of a curve, thinned.
///
/// Curves take the energy of a cycle from the velocity amplitude v = ω u (Eq. 7); where ω falls with u, v falls more slowly than u. The energy itself
/// falls by the work of the force at the tips, (K_∞ + F(u)/u) u du, which is ω² u du but for a hundredth of the softening. So the dissipation D of a
/// cycle is the curves' value over 1 + d ln ω/d ln u.
pub(super) fn entries(curves: &Curves) -> Vec<Entry> {
    let stride = curves.t.len().div_ceil(ENTRIES).max(1);
    let last = curves.t.len().saturating_sub(1);
    let log_ratio = |v: &[f64], i: usize| (v[(i + 1).min(last)] / v[i.saturating_sub(1)]).ln();
    let slope = |i: usize| {
        let slope = log_ratio(&curves.frequency, i) / log_ratio(&curves.displacement, i);
        if slope.abs() < STEEPEST { slope } else { 0.0 }
    };
    let entry = |i: usize| {
        let omega = TAU * curves.frequency[i];
        Entry {
            displacement: curves.displacement[i],
            dissipation: curves.dissipation[i] / (1.0 + slope(i)),
            log_sd: curves.log_dissipation_sd[i].max(DISSIPATION_FLOOR),
            omega,
            omega_sd: (TAU * curves.frequency_sd[i]).max(FREQUENCY_FLOOR * omega),
        }
    };
    let usable = |e: &Entry| {
        let all = [e.displacement, e.dissipation, e.log_sd, e.omega, e.omega_sd];
        all.iter().all(|v| v.is_finite()) && e.displacement > 0.0 && e.dissipation > 0.0
    };
    let cut = (ENDS * curves.t.len() as f64) as usize;
    (cut..curves.t.len() - cut).step_by(stride).map(entry).filter(usable).collect()
}
