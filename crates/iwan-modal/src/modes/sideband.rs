//! Modes that are probably not modes: sidebands of a modulation.
//!
//! When a structure sways on a soft suspension, its modes have another stiffness, or its sensors another angle, at each instant of the sway. A mode λ whose
//! frequency is modulated at ω by a motion that decays with σ has parts at λ - σ ± iω: they have the mode's shape, are weaker, no less damped, and stand at one distance
//! on both sides of every mode. A fit takes them for modes.

use std::f64::consts::TAU;

use super::compare::mac;
use crate::fit::Fitted;

/// A sideband's peak is lower than this fraction of its mode's peak. A judgement: a modulation that turns the phase by one radian makes 0.58.
const LOWER: f64 = 0.5;
/// A sideband has the mode's shape, with at least this modal assurance criterion: noise and the neighbours' sidebands disturb a weak peak.
const ALIKE: f64 = 0.9;
/// A sideband decays no slower than this fraction of the mode's decay. Noise may hide some of its decay.
const DECAY: f64 = 0.8;
/// A sideband stands at most this fraction of the mode's frequency away: suspensions that count as soft are tuned to a tenth of the first mode or less (ISO 7626-5), and modes
/// of strings and rods, which lie at equal distances too, are farther apart up to the tenth mode.
const REACH: f64 = 0.1;
/// A sideband stands at least this many sums of both decays away: a nearer one is a second half of the mode's own peak.
const APART: f64 = 1.25;
/// The place of a sideband is uncertain by this fraction of its half-power half width, because it is no pure exponential.
const WIDTH: f64 = 0.5;
/// Its place is also uncertain by this many standard deviations.
const DEVIATIONS: f64 = 2.0;
/// Both together are at most this fraction of its distance: a less certain sideband would fit many distances.
const CERTAIN: f64 = 0.25;
/// Least number of modes with sidebands on both sides: two neighbours at one distance stand about one mode by chance.
const BOTH_SIDES: usize = 2;
/// Largest probability with which as many modes stand at one distance by chance.
const BY_CHANCE: f64 = 0.01;

/// A mode that is probably a sideband of another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sideband {
    /// Index of the sideband among the modes.
    pub mode: usize,
    /// Index of the mode that it belongs to.
    pub of: usize,
}

/// Modes that are probably sidebands of a modulation.
#[derive(Debug, Clone, PartialEq)]
pub struct Sidebands {
    /// Frequency of the modulation, Hz.
    pub frequency: f64,
    /// The sidebands, by the index (and so the frequency) of their modes.
    pub all: Vec<Sideband>,
}

/// A weaker mode beside a stronger one of its shape.
#[derive(Clone, Copy)]
struct Beside {
    mode: usize,
    of: usize,
    /// Distance in frequency, Hz; negative below the stronger mode.
    distance: f64,
    /// Uncertainty of that distance, Hz.
    uncertain: f64,
    /// Width of the range of distances that would have counted, Hz.
    room: f64,
}

/// The modulation at whose distance most weaker modes stand beside stronger ones, among the poles `chosen`; none where chance does as much.
pub(crate) fn sidebands(fitted: &Fitted, chosen: &[usize]) -> Option<Sidebands> {
    let pairs = pairs(fitted, chosen);
    let at = |d: f64| -> Vec<Beside> {
        pairs.iter().copied().filter(|p| (p.distance.abs() - d).abs() < p.uncertain).collect()
    };
    let all = pairs.iter().map(|p| at(p.distance.abs())).max_by_key(Vec::len)?;
    // The mean of all distances, weighted by their certainty, is the one at which they are counted again.
    let weight = |p: &Beside| p.uncertain.powi(-2);
    let sum: f64 = all.iter().map(|p| weight(p) * p.distance.abs()).sum();
    let frequency = sum / all.iter().map(weight).sum::<f64>();
    let all = at(frequency);
    let side = |of: usize, sign: f64| all.iter().any(|p| p.of == of && p.distance * sign > 0.0);
    let both = chosen.iter().filter(|k| side(**k, -1.0) && side(**k, 1.0)).count();
    let expected: f64 = pairs.iter().map(|p| (2.0 * p.uncertain / p.room).min(1.0)).sum();
    let chance = pairs.len() as f64 * at_least(all.len().saturating_sub(1), expected);
    if both < BOTH_SIDES || chance > BY_CHANCE {
        return None;
    }
    let place = |p: usize| chosen.iter().position(|q| *q == p);
    // A sideband of a sideband also belongs to the mode, at twice the distance. Each step leads to a higher peak.
    let mode_of = |mut of: usize| {
        while let Some(next) = all.iter().find(|p| p.mode == of) {
            of = next.of;
        }
        of
    };
    let one = |p: &Beside| {
        let of = mode_of(p.of);
        // One that leads from a sideband back to its mode is a second half of the mode's own peak.
        apart(fitted, p.mode, of).then_some(Sideband { mode: place(p.mode)?, of: place(of)? })
    };
    let mut all: Vec<Sideband> = all.iter().filter_map(one).collect();
    // A sideband between two modes is named once.
    all.sort_by_key(|s| s.mode);
    all.dedup_by_key(|s| s.mode);
    Some(Sidebands { frequency, all })
}

/// Every mode of those `chosen`, paired with every stronger one of which it might be a sideband.
fn pairs(fitted: &Fitted, chosen: &[usize]) -> Vec<Beside> {
    let decay = |p: usize| -fitted.poles[p].re;
    let height = |p: usize| {
        let parts = fitted.residues[p].iter().zip(&fitted.noise).map(|(r, noise)| r.norm_sqr() / noise);
        parts.sum::<f64>().sqrt() / decay(p)
    };
    let heights: Vec<f64> = chosen.iter().map(|p| height(*p)).collect();
    let mut pairs = Vec::new();
    for (k, &of) in chosen.iter().enumerate() {
        // A mode that is a second half of a stronger peak has no sidebands of its own.
        if (0..chosen.len()).any(|q| heights[q] > heights[k] && !apart(fitted, of, chosen[q])) {
            continue;
        }
        for (j, &mode) in chosen.iter().enumerate() {
            let distance = (fitted.poles[mode].im - fitted.poles[of].im) / TAU;
            let (nearest, farthest) =
                (APART * (decay(mode) + decay(of)) / TAU, REACH * fitted.poles[of].im / TAU);
            let variance = fitted.certainty.pole(mode)[1] + fitted.certainty.pole(of)[1];
            let uncertain = (DEVIATIONS * variance.sqrt()).hypot(WIDTH * decay(mode)) / TAU;
            let counts = heights[j] < LOWER * heights[k]
                && (nearest..farthest).contains(&distance.abs())
                && uncertain < CERTAIN * distance.abs()
                && decay(mode) > DECAY * decay(of)
                && mac(&fitted.residues[mode], &fitted.residues[of]) > ALIKE;
            if counts {
                pairs.push(Beside { mode, of, distance, uncertain, room: farthest - nearest });
            }
        }
    }
    pairs
}

/// Whether two poles are far enough from each other to be two peaks.
fn apart(fitted: &Fitted, p: usize, q: usize) -> bool {
    let (a, b) = (fitted.poles[p], fitted.poles[q]);
    (a - b).norm() > APART * (a.re + b.re).abs()
}

/// Probability that a Poisson distributed number with this mean is `count` or larger.
fn at_least(count: usize, mean: f64) -> f64 {
    let (mut term, mut below) = ((-mean).exp(), 0.0);
    for n in 0..count {
        below += term;
        term *= mean / (n + 1) as f64;
    }
    (1.0 - below).max(0.0)
}
