//! Beyond the best joints: which mode measured next would tell most, and what frequency and damping want of each other.

use iwan_fem::{NamedModes, Stiffness};
use iwan_ident::estimate::{Model, Told, least};
use serde::Serialize;

use super::fitted::{Fit, mean_frequency};
use super::model::Beside;

/// Elastic modes that are asked what they would tell: beyond, tests with a hammer seldom reach.
const ASKED: usize = 12;
/// Amplitudes at which such a mode is taken to be measured, over two decades: as many as a short ring-down has independent values.
const AMPLITUDES: usize = 12;
/// A mode would tell an unknown where it leaves less than this part of the deviation that is plausible before: half, which takes a factor of 33 either way
/// to one of six.
const TELLS: f64 = 0.5;
/// Relative deviations of a frequency and of a damping ratio that a further mode is measured with at best: what frequencies of one specimen do from day
/// to day with temperature, and what its damping does from hit to hit. Judgements.
const MEASURED_AT_BEST: (f64, f64) = (1e-4, 0.03);
/// Weight of damping over that of frequency at the ends of the front: a thousand times more or less than the curves' own noise says.
const FARTHEST: f64 = 1e3;

/// A mode that was not measured, and what it would tell.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NextMode {
    /// Mode.
    pub mode: String,
    /// Stuck frequency with the joints found, Hz.
    pub frequency: f64,
    /// Sum of ln(deviation before / deviation after) over the parameters of the joints that the curves leave open: what it would tell in all.
    pub gain: f64,
    /// What of these it would tell best: group and parameter, …
    pub parameter: String,
    /// … and its standard deviation after over before.
    pub remaining: f64,
    /// Largest modal displacement it would need, at which it is at most as fast as the measured modes were and no joint slips more than in them.
    pub displacement: f64,
}

/// The best compromise of frequency and damping at one weight.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TradeOff {
    /// Weight of damping over that of frequency; 1: as their noise says.
    pub weight: f64,
    /// Root-mean-square misfit of frequency over its measured shift.
    pub frequency: f64,
    /// Root-mean-square misfit of ln ζ.
    pub damping: f64,
    /// The coordinates there: ln K_T, ln F_S, χ, β/(1+β) of each group, and the linear unknowns.
    pub x: Vec<f64>,
}

/// Names of the parameters of a law, as in results.
pub(super) const PARAMETERS: [&str; 4] = ["k_t", "f_s", "chi", "beta"];

/// The modes not measured that would tell a parameter which the curves leave open, no faster than the measured ones were; those that would tell most
/// first. `open` are the numbers of these parameters among the coordinates.
pub(super) fn next_modes(
    fit: &Fit<'_>,
    named: &NamedModes,
    groups: &[String],
    open: &[usize],
) -> Vec<NextMode> {
    let Some(adjusted) = fit.model.adjusted(&fit.found.x) else { return Vec::new() };
    let reach = largest_slips(fit);
    let points = || fit.model.curves.iter().flat_map(|curve| &curve.points);
    // A hammer gives modes about the same velocity, and to a fast one a small displacement.
    let fastest = points().map(|p| p.displacement * p.frequency).fold(0.0_f64, f64::max);
    // Damping below the least that was measured drowns in what the structure loses elsewhere.
    let least = points().map(|p| p.log_damping).fold(f64::INFINITY, f64::min).exp();
    let (frequency_sd, damping_sd) = noise(&fit.model);
    let (frequency_sd, damping_sd) =
        (frequency_sd.max(MEASURED_AT_BEST.0), damping_sd.max(MEASURED_AT_BEST.1));
    // With the unknowns that the curves so far do not feel.
    let all: Vec<usize> = (0..fit.model.bounds.len()).collect();
    let Ok(told) = Told::about(&fit.model, &fit.found, &all, fit.variance) else { return Vec::new() };
    let before = told.deviations();
    let measured = |number: usize| fit.model.curves.iter().any(|curve| curve.mode == number);
    let of = |mode: &iwan_fem::NamedMode| {
        let stuck = adjusted.mode(mode.pair.stuck).ok()?;
        let held = |(slip, reach): (usize, f64)| reach / stuck.shape()[slip].abs().max(f64::MIN_POSITIVE);
        let farthest = fastest / named.frequency_stuck(mode);
        let largest = reach.iter().copied().enumerate().map(held).fold(farthest, f64::min);
        let below = |i: usize| 100.0_f64.powf(-(i as f64) / (AMPLITUDES as f64 - 1.0));
        let q: Vec<f64> = (0..AMPLITUDES).rev().map(|i| largest * below(i)).collect();
        let with = (mode.pair.stuck, None, Stiffness::FirstHarmonic);
        let said = fit.model.said(&adjusted, &fit.found.x, with, &q)?;
        let mut slopes: Vec<Vec<f64>> = Vec::new();
        for s in &said {
            slopes.push(s.frequency_by.iter().map(|by| by / (frequency_sd * s.frequency)).collect());
        }
        // The mode has a linear damping of its own, which nobody knows before: only what damping does with amplitude tells of joints.
        let ratios: Vec<f64> = said.iter().map(|s| s.log_damping.exp()).collect();
        let unit = |ratio: f64| 1.0 / (damping_sd * (ratio + least));
        let own: f64 = ratios.iter().map(|r| unit(*r).powi(2)).sum();
        let of_damping = |i: usize, j: usize| said[i].log_damping_by[j] * ratios[i] * unit(ratios[i]);
        let along = |j: usize| (0..said.len()).map(|i| unit(ratios[i]) * of_damping(i, j)).sum::<f64>() / own;
        let along: Vec<f64> = all.iter().map(|j| along(*j)).collect();
        for (i, ratio) in ratios.iter().enumerate() {
            slopes.push(all.iter().map(|j| of_damping(i, *j) - unit(*ratio) * along[*j]).collect());
        }
        let finite = slopes.iter().flatten().all(|s: &f64| s.is_finite());
        let after = told.deviations_with(&slopes);
        let share = |j: &usize| after[*j] / before[*j];
        let best = *open.iter().min_by(|a, b| share(a).total_cmp(&share(b))).filter(|_| finite)?;
        (share(&best) < TELLS).then(|| NextMode {
            mode: mode.name.clone(),
            frequency: said.first().map_or(0.0, |s| s.frequency),
            gain: open.iter().map(|j| -share(j).ln()).sum(),
            parameter: format!("{} of {}", PARAMETERS[best % 4], groups[best / 4]),
            remaining: share(&best),
            displacement: largest,
        })
    };
    let others = named.elastic.iter().take(ASKED).filter(|mode| !measured(mode.pair.stuck));
    let mut modes: Vec<NextMode> = others.filter_map(of).collect();
    modes.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    modes
}

/// Which mode to measure next, in words.
pub(super) fn in_words(adequate: bool, open: &[usize], modes: &[NextMode]) -> String {
    match modes.first() {
        _ if !adequate => {
            "measure next: not said, as the structure does not describe what was measured".into()
        }
        _ if open.is_empty() => {
            "measure next: nothing is needed, all parameters of the joints are told".into()
        }
        Some(next) => format!(
            "measure next: {} ({:.1} Hz) up to the modal displacement {:.2e}, which would tell most of {}",
            next.mode, next.frequency, next.displacement, next.parameter
        ),
        None => format!(
            "measure next: none of the first {ASKED} elastic modes would tell what is open, at velocities up to those measured"
        ),
    }
}

/// Largest slip of each joint in the measured curves.
fn largest_slips(fit: &Fit<'_>) -> Vec<f64> {
    let count = fit.model.adjustable.slips().len();
    let mut largest = vec![0.0_f64; count];
    let Some(adjusted) = fit.model.adjusted(&fit.found.x) else { return largest };
    for curve in &fit.model.curves {
        let Some(last) = curve.points.last() else { continue };
        let mode = adjusted.mode(curve.mode);
        let points = mode.and_then(|mode| mode.curve(&adjusted, &[last.displacement], curve.stiffness));
        for point in points.into_iter().flatten() {
            largest.iter_mut().zip(&point.slips).for_each(|(most, s)| *most = most.max(s.abs()));
        }
    }
    // A joint that hardly slipped so far may slip as much as the others.
    let most = largest.iter().fold(0.0_f64, |m, s| m.max(*s));
    largest.iter().map(|_| most).collect()
}

/// Relative deviations of frequency and damping in the measured curves, in the mean.
fn noise(model: &Beside<'_>) -> (f64, f64) {
    let n = model.curves.len() as f64;
    let frequency = model.curves.iter().map(|c| c.frequency_sd / mean_frequency(c)).sum::<f64>() / n;
    (frequency, model.curves.iter().map(|c| c.damping_sd).sum::<f64>() / n)
}

/// The front of compromises: `count` weights, evenly spaced on a logarithmic scale.
pub(super) fn front(fit: &Fit<'_>, count: usize) -> Vec<TradeOff> {
    let weight = |i: usize| {
        let share = if count > 1 { i as f64 / (count - 1) as f64 } else { 0.5 };
        FARTHEST.powf(2.0 * share - 1.0)
    };
    let mut weights: Vec<f64> = (0..count).map(weight).collect();
    // From the middle outwards, each from its neighbour.
    weights.sort_by(|a, b| a.ln().abs().total_cmp(&b.ln().abs()));
    let mut points: Vec<TradeOff> = Vec::new();
    for weight in weights {
        let mut model = fit.model.clone();
        for curve in &mut model.curves {
            curve.frequency_sd *= weight.powf(0.25);
            curve.damping_sd *= weight.powf(-0.25);
        }
        let near = |t: &&TradeOff| (t.weight.ln() - weight.ln()).abs();
        let start = points.iter().min_by(|a, b| near(a).total_cmp(&near(b)));
        let start = start.map_or_else(|| fit.found.x.clone(), |t| t.x.clone());
        let Ok(found) = least(&model, &[start], &fit.free) else { continue };
        if let Some((frequency, damping)) = misfits(&fit.model, &found.x) {
            points.push(TradeOff { weight, frequency, damping, x: found.x });
        }
    }
    points.sort_by(|a, b| a.weight.total_cmp(&b.weight));
    points
}

/// Root mean squares of both kinds of misfit.
fn misfits(model: &Beside<'_>, x: &[f64]) -> Option<(f64, f64)> {
    let mut residuals = vec![0.0; model.count()];
    let known = model.evaluate(x, &mut residuals, None);
    let (mut frequency, mut damping, mut count) = (0.0, 0.0, 0.0);
    for (curve, series) in model.curves.iter().zip(model.series().chunks_exact(2)) {
        let range = curve
            .points
            .iter()
            .fold((f64::INFINITY, 0.0_f64), |r, p| (r.0.min(p.frequency), r.1.max(p.frequency)));
        let shift = (range.1 - range.0).max(1e-5 * range.1);
        let square = |part: &std::ops::Range<usize>, unit: f64| {
            residuals[part.clone()].iter().map(|r| (r * unit).powi(2)).sum::<f64>()
        };
        frequency += square(&series[0], curve.frequency_sd / shift);
        damping += square(&series[1], curve.damping_sd);
        count += curve.points.len() as f64;
    }
    known.then(|| ((frequency / count).sqrt(), (damping / count).sqrt()))
}
