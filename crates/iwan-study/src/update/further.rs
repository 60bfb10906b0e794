//! Advice after the fit: which mode, measured next, would add most information, and how frequency and damping trade off against each other.

use iwan_fem::{NamedModes, Stiffness};
use iwan_ident::estimate::{Model, Told, least};
use serde::Serialize;

use super::fitted::{Fit, mean_frequency};
use super::model::Beside;

/// Number of elastic modes that are considered as the next measurement: tests with a hammer seldom reach higher ones.
const ASKED: usize = 12;
/// Number of amplitudes, over two decades, at which such a mode is assumed to be measured: as many as a short ring-down has independent values.
const AMPLITUDES: usize = 12;
/// A mode is advised where its measurement leaves less than this part of an unknown's standard deviation: half, which narrows a plausible range of a
/// factor of 33 either way to one of six.
const TELLS: f64 = 0.5;
/// Best relative standard deviations with which a further mode is assumed to be measured, of the frequency and of the damping ratio: how frequencies
/// of one specimen vary from day to day with temperature, and its damping from hit to hit. Judgements.
const MEASURED_AT_BEST: (f64, f64) = (1e-4, 0.03);
/// Largest weight of damping over frequency on the front of compromises, and the inverse of the smallest: a thousand times what the curves' own noise
/// gives.
const FARTHEST: f64 = 1e3;

/// A mode that was not measured, and the information that its measurement would add.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NextMode {
    /// Name of the mode.
    pub mode: String,
    /// Stuck frequency with the joints found, Hz.
    pub frequency: f64,
    /// Sum of ln(standard deviation before / after) over those joint parameters that the curves leave open: the information in total.
    pub gain: f64,
    /// The parameter, with its group, on which the mode would add most information, …
    pub parameter: String,
    /// … and the standard deviation of this parameter after the measurement over that before.
    pub remaining: f64,
    /// Largest modal displacement that the measurement needs: the mode then moves at most as fast as the measured modes, and no joint slips more than
    /// the one that slipped most in them.
    pub displacement: f64,
}

/// The best compromise between frequency and damping at one weight.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TradeOff {
    /// Weight of damping over that of frequency; 1 weights both by their noise.
    pub weight: f64,
    /// Root-mean-square misfit of frequency over its measured shift.
    pub frequency: f64,
    /// Root-mean-square misfit of ln ζ.
    pub damping: f64,
    /// The coordinates of this compromise: ln K_T, ln F_S, χ, β/(1+β) of each group, and the linear unknowns.
    pub x: Vec<f64>,
}

/// Names of the parameters of a law, as in results.
pub(super) const PARAMETERS: [&str; 4] = ["k_t", "f_s", "chi", "beta"];

/// The modes that were not measured and would determine a parameter that the curves leave open, at no higher velocity than the measured modes had;
/// the most informative come first. `open` are the indices of these parameters among the coordinates.
pub(super) fn next_modes(
    fit: &Fit<'_>,
    named: &NamedModes,
    groups: &[String],
    open: &[usize],
) -> Vec<NextMode> {
    let Some(adjusted) = fit.model.adjusted(&fit.found.x) else { return Vec::new() };
    let reach = largest_slip(fit);
    let slips = fit.model.adjustable.slips().len();
    let points = || fit.model.curves.iter().flat_map(|curve| &curve.points);
    // A hammer gives all modes about the same velocity, so that a fast mode has a small displacement.
    let fastest = points().map(|p| p.displacement * p.frequency).fold(0.0_f64, f64::max);
    // Damping below the least that was measured cannot be told from other losses of the structure.
    let least = points().map(|p| p.log_damping).fold(f64::INFINITY, f64::min).exp();
    let (frequency_sd, damping_sd) = noise(&fit.model);
    let (frequency_sd, damping_sd) =
        (frequency_sd.max(MEASURED_AT_BEST.0), damping_sd.max(MEASURED_AT_BEST.1));
    // Unknowns to which the curves are insensitive so far are included.
    let all: Vec<usize> = (0..fit.model.bounds.len()).collect();
    let Ok(told) = Told::about(&fit.model, &fit.found, &all, fit.variance) else { return Vec::new() };
    let before = told.deviations();
    let measured = |number: usize| fit.model.curves.iter().any(|curve| curve.mode == number);
    let of = |mode: &iwan_fem::NamedMode| {
        let stuck = adjusted.mode(mode.pair.stuck).ok()?;
        let farthest = fastest / named.frequency_stuck(mode);
        let unit_slips = (0..slips).map(|slip| stuck.shape()[slip].abs());
        let largest = unit_slips.map(|slip| reach / slip.max(f64::MIN_POSITIVE)).fold(farthest, f64::min);
        let below = |i: usize| 100.0_f64.powf(-(i as f64) / (AMPLITUDES as f64 - 1.0));
        let q: Vec<f64> = (0..AMPLITUDES).rev().map(|i| largest * below(i)).collect();
        let with = (mode.pair.stuck, None, Stiffness::FirstHarmonic);
        let said = fit.model.said(&adjusted, &fit.found.x, with, &q)?;
        let mut slopes: Vec<Vec<f64>> = Vec::new();
        for s in &said {
            slopes.push(s.frequency_by.iter().map(|by| by / (frequency_sd * s.frequency)).collect());
        }
        // The mode has a linear damping of its own, which is unknown: only the change of damping with amplitude gives information on the joints.
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

/// The advice on the next measurement, in words.
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

/// The slip up to which joints may be taken as tested: the largest of any joint in the measured curves. A joint that hardly slipped so far may slip as much as
/// the one that slipped most.
fn largest_slip(fit: &Fit<'_>) -> f64 {
    let mut largest = 0.0_f64;
    let Some(adjusted) = fit.model.adjusted(&fit.found.x) else { return largest };
    for curve in &fit.model.curves {
        let Some(last) = curve.points.last() else { continue };
        let mode = adjusted.mode(curve.mode);
        let points = mode.and_then(|mode| mode.curve(&adjusted, &[last.displacement], curve.stiffness));
        for point in points.into_iter().flatten() {
            largest = point.slips.iter().fold(largest, |most, s| most.max(s.abs()));
        }
    }
    largest
}

/// Mean relative standard deviations of frequency and damping in the measured curves.
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
    // The compromises are computed from the middle outwards, each from its neighbour.
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

/// Root mean squares of the misfits of frequency and of damping.
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
