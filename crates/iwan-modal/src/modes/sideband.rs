//! Modes that are probably none: sidebands of a modulation.
//!
//! A structure that sways on a soft suspension meets its modes at another stiffness, or its sensors at another angle, at each turn of the sway. A mode λ with
//! the frequency modulated at ω by a motion that decays with σ has parts at λ - σ ± iω: of the mode's shape, weaker, no less damped, at one distance
//! on both sides of every mode. A fit takes them for modes.

use std::f64::consts::TAU;

use super::compare::mac;
use crate::fit::Fitted;

/// A sideband's peak is lower than this part of its mode's. A judgement: a modulation that turns the phase by one radian makes 0.58.
const LOWER: f64 = 0.5;
/// It has the mode's shape by this modal assurance criterion: noise and the neighbours' sidebands disturb a weak peak.
const ALIKE: f64 = 0.9;
/// It decays no slower than this part of the mode does. Noise may hide some of it.
const DECAY: f64 = 0.8;
/// It stands at most this part of the mode's frequency away: suspensions that count as soft are tuned to a tenth of the first mode or less (ISO 7626-5), and modes of strings and rods,
/// which lie at equal distances too, are farther apart up to the tenth.
const REACH: f64 = 0.1;
/// It stands at least this many sums of both decays away: nearer, it is a second half of the mode's own peak.
const APART: f64 = 1.25;
/// Its place is uncertain by this part of its half-power half width, for it is no pure exponential, …
const WIDTH: f64 = 0.5;
/// … and by this many standard deviations, …
const DEVIATIONS: f64 = 2.0;
/// … together at most this part of its distance: what is less certain stands at many distances.
const CERTAIN: f64 = 0.25;
/// Modes with sidebands on both sides that a modulation needs at least: two neighbours at one distance stand about one mode by chance.
const BOTH_SIDES: usize = 2;
/// Probability with which as many modes stand at one distance by chance, at most.
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
    /// By ascending frequency.
    pub all: Vec<Sideband>,
}

/// A weaker mode beside a stronger one of its shape.
#[derive(Clone, Copy)]
struct Beside {
    mode: usize,
    of: usize,
    /// Hz, below zero on the lower side.
    distance: f64,
    /// How far it may be off, Hz.
    uncertain: f64,
    /// Distances that would have counted, Hz.
    room: f64,
}

/// The modulation at whose distance most weaker modes stand beside stronger ones; none where chance does as much.
pub(crate) fn sidebands(fitted: &Fitted, chosen: &[usize]) -> Option<Sidebands> {
    let pairs = pairs(fitted, chosen);
    let at = |d: f64| -> Vec<Beside> {
        pairs.iter().copied().filter(|p| (p.distance.abs() - d).abs() < p.uncertain).collect()
    };
    let all = pairs.iter().map(|p| at(p.distance.abs())).max_by_key(Vec::len)?;
    // The middle of all, each as certain as it is, counts again.
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
    // The sideband of a sideband is one of its mode too, at twice the distance. Each step leads to a higher peak.
    let mode_of = |mut of: usize| {
        while let Some(next) = all.iter().find(|p| p.mode == of) {
            of = next.of;
        }
        of
    };
    let one = |p: &Beside| {
        let of = mode_of(p.of);
        // From a sideband back to its mode: a second half of the mode's own peak.
        apart(fitted, p.mode, of).then_some(Sideband { mode: place(p.mode)?, of: place(of)? })
    };
    let mut all: Vec<Sideband> = all.iter().filter_map(one).collect();
    // One between two modes is named once.
    all.sort_by_key(|s| s.mode);
    all.dedup_by_key(|s| s.mode);
    Some(Sidebands { frequency, all })
}

/// Every mode of those `chosen` beside every stronger one that it might be a sideband of.
fn pairs(fitted: &Fitted, chosen: &[usize]) -> Vec<Beside> {
    let decay = |p: usize| -fitted.poles[p].re;
    let height = |p: usize| {
        let parts = fitted.residues[p].iter().zip(&fitted.noise).map(|(r, noise)| r.norm_sqr() / noise);
        parts.sum::<f64>().sqrt() / decay(p)
    };
    let heights: Vec<f64> = chosen.iter().map(|p| height(*p)).collect();
    let mut pairs = Vec::new();
    for (k, &of) in chosen.iter().enumerate() {
        // A second half of a stronger peak has no sidebands of its own.
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

/// Whether two poles stand far enough from each other to be two peaks.
fn apart(fitted: &Fitted, p: usize, q: usize) -> bool {
    let (a, b) = (fitted.poles[p], fitted.poles[q]);
    (a - b).norm() > APART * (a.re + b.re).abs()
}

/// Probability that a Poisson distributed number of this mean is so large or larger.
fn at_least(count: usize, mean: f64) -> f64 {
    let (mut term, mut below) = ((-mean).exp(), 0.0);
    for n in 0..count {
        below += term;
        term *= mean / (n + 1) as f64;
    }
    (1.0 - below).max(0.0)
}
