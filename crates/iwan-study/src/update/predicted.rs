//! Predictions for modes that were kept out of the fit: their uncertainty, by what the curves determine and by what they leave open.

use iwan_fem::Stiffness;
use iwan_ident::estimate::{Interval, near};
use serde::Serialize;

use super::fitted::{ENDS, Fit, NORMAL};
use super::measured::Point;
use super::model::Said;
use super::verdict::{OWN, SHIFT_FLOOR, scatter};

/// Steps from the best value along the open side of an unknown, in its coordinate: up to a factor of 33 on K_T and F_S, beyond which no engineer
/// would call a value plausible. χ and β/(1+β) reach their bounds before.
const STEPS: [f64; 4] = [0.5, 1.0, 2.0, 3.5];
/// Iterations and relative reduction of the search for the other unknowns at such a step: few iterations show whether the curves accept the step.
const EFFORT: (usize, f64) = (10, 1e-3);
/// Where an open unknown changes the damping by more than this factor, a sentence says that the prediction has a wide band only: a prediction within
/// a factor of two still serves a design. A judgement.
const MOST_DAMPING: f64 = 2.0;
/// Limit for the frequency, as a part of its measured shift: where an open unknown changes it by more than half of the shift, the shift is not
/// predicted.
const MOST_SHIFT: f64 = 0.5;

/// A prediction compared with the measured curve.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Prediction {
    /// Measured minus predicted frequency where the difference is largest, Hz, …
    pub frequency_misfit: f64,
    /// … and as a part of the frequency.
    pub relative_frequency_misfit: f64,
    /// Measured over predicted damping ratio, minus 1, where the difference is largest.
    pub damping_misfit: f64,
    /// Share of the measured frequencies that lie in the 95 % band of the prediction; none where there is no band.
    pub frequency_inside: Option<f64>,
    /// Share of the measured damping ratios that lie in the 95 % band; none where there is no band.
    pub damping_inside: Option<f64>,
    /// What cannot be predicted and why, in whole sentences.
    pub not_predicted: Vec<String>,
}

/// Standard deviations of a prediction, one entry per point.
#[derive(Debug, Clone)]
pub(super) struct Spread {
    /// Standard deviation of the frequency, Hz; infinite where it cannot be predicted.
    pub(super) frequency: Vec<f64>,
    /// Standard deviation of ln ζ; infinite where it cannot be predicted.
    pub(super) log_damping: Vec<f64>,
    /// What cannot be predicted and why, in whole sentences.
    pub(super) not_predicted: Vec<String>,
}

/// The mode that is to be predicted.
#[derive(Debug, Clone, Copy)]
pub(super) struct Asked<'a> {
    pub(super) mode: &'a str,
    pub(super) with: (usize, Option<usize>, Stiffness),
    pub(super) points: &'a [Point],
    /// Frequency and damping of the structure at the points.
    pub(super) said: &'a [Said],
    /// Guess of the viscous damping ratio, which is added to the damping by the joints.
    pub(super) guessed: f64,
    /// Whether modes have viscous damping of their own.
    pub(super) viscous: bool,
    /// Whether the structure describes the curves that were fitted.
    pub(super) adequate: bool,
}

/// Uncertainty of a prediction, from three sources: the uncertainty of what the curves determine; each unknown that the curves leave open, as far as
/// the curves accept it; and the mode's own linear damping.
pub(super) fn spread(fit: &Fit<'_>, intervals: &[Interval], names: &[String], asked: Asked<'_>) -> Spread {
    let n = asked.points.len();
    if !asked.adequate {
        let why = format!(
            "frequency and damping of {} are computed, not predicted: the structure does not describe the modes that were fitted",
            asked.mode
        );
        let infinite = vec![f64::INFINITY; n];
        return Spread { frequency: infinite.clone(), log_damping: infinite, not_predicted: vec![why] };
    }
    let total = |said: &Said| (said.log_damping.exp() + asked.guessed).ln();
    let mut squares: Vec<(f64, f64)> = asked
        .said
        .iter()
        .map(|said| (fit.told.deviation(&said.frequency_by), fit.told.deviation(&said.log_damping_by)))
        .map(|(frequency, damping)| (frequency.powi(2), damping.powi(2)))
        .collect();
    let shift = shift_of(asked.points);
    let mut not_predicted = Vec::new();
    for (j, interval) in intervals.iter().enumerate().take(fit.model.first_viscous()) {
        let mut farthest = vec![(0.0_f64, 0.0_f64); n];
        for (direction, _) in
            [(-1.0, interval.low), (1.0, interval.high)].iter().filter(|(_, end)| end.is_none())
        {
            for said in accepted(fit, j, *direction, asked) {
                for ((far, said), best) in farthest.iter_mut().zip(&said).zip(asked.said) {
                    far.0 = far.0.max((said.frequency - best.frequency).abs());
                    far.1 = far.1.max((total(said) - total(best)).abs());
                }
            }
        }
        let most =
            farthest.iter().fold((0.0_f64, 0.0_f64), |most, far| (most.0.max(far.0), most.1.max(far.1)));
        if most.1 > MOST_DAMPING.ln() {
            let factor = most.1.exp();
            not_predicted.push(format!(
                "the damping of {} is predicted within a wide band only: the curves leave {} open, which moves it by a factor of up to {factor:.1}",
                asked.mode, parameter(&names[j])
            ));
        }
        if most.0 > MOST_SHIFT * shift {
            not_predicted.push(format!(
                "the frequency of {} is predicted within a wide band only: the curves leave {} open, which moves it by up to {:.3} Hz, and its measured \
                 shift is {shift:.3} Hz",
                asked.mode, parameter(&names[j]), most.0
            ));
        }
        for (square, far) in squares.iter_mut().zip(&farthest) {
            square.0 += (far.0 / NORMAL).powi(2);
            square.1 += (far.1 / NORMAL).powi(2);
        }
    }
    let frequency = squares.iter().map(|square| square.0.sqrt()).collect();
    let mut log_damping: Vec<f64> = squares.iter().map(|square| square.1.sqrt()).collect();
    if asked.viscous && asked.with.1.is_none() {
        let ratios = asked.said.iter().map(|said| said.log_damping.exp());
        let (low, high) = ratios.fold((f64::INFINITY, 0.0_f64), |r, ratio| (r.0.min(ratio), r.1.max(ratio)));
        not_predicted.push(format!(
            "the damping of {} cannot be predicted as a whole: its own linear (viscous) damping was not measured; the joints alone make {low:.2e} to \
             {high:.2e} of it, and --undamped says that there is nothing else",
            asked.mode
        ));
        log_damping.fill(f64::INFINITY);
    }
    Spread { frequency, log_damping, not_predicted }
}

/// Curves of a mode along an open unknown, as far as the measured curves accept it while the other unknowns are fitted again.
fn accepted(fit: &Fit<'_>, j: usize, direction: f64, asked: Asked<'_>) -> Vec<Vec<Said>> {
    let others: Vec<usize> = fit.free.iter().copied().filter(|k| *k != j).collect();
    let q: Vec<f64> = asked.points.iter().map(|p| p.displacement).collect();
    let (low, high) = fit.model.bounds[j];
    let mut all = Vec::new();
    for step in STEPS {
        let mut x = fit.found.x.clone();
        x[j] = (x[j] + direction * step).clamp(low, high);
        let Some(found) = near(&fit.model, &x, &others, EFFORT) else { break };
        if found.cost - fit.found.cost > ENDS * fit.variance {
            break;
        }
        let said = fit.model.adjusted(&found.x);
        let said = said.and_then(|adjusted| fit.model.said(&adjusted, &found.x, asked.with, &q));
        // Where parts slide freely at these amplitudes, the mode has no curve.
        let Some(said) = said else { break };
        all.push(said);
        if x[j] <= low || x[j] >= high {
            break;
        }
    }
    all
}

/// The parameter behind a coordinate: `k_t of link` for `ln k_t of link`.
fn parameter(name: &str) -> &str {
    name.strip_prefix("ln ").unwrap_or(name)
}

/// Measured shift of the frequency, Hz.
fn shift_of(points: &[Point]) -> f64 {
    let range = points
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |r, p| (r.0.min(p.frequency), r.1.max(p.frequency)));
    (range.1 - range.0).max(SHIFT_FLOOR * range.1)
}

/// Compares the prediction (frequencies, damping ratios and their standard deviations) with the measured points.
pub(super) fn held_against(
    points: &[Point],
    frequency: &[f64],
    damping: &[f64],
    spread: &Spread,
) -> Prediction {
    let misfits: Vec<f64> = points.iter().zip(frequency).map(|(p, f)| p.frequency - f).collect();
    let logs: Vec<f64> = points.iter().zip(damping).map(|(p, ratio)| p.log_damping - ratio.ln()).collect();
    let largest = |values: &[f64]| {
        let places = 0..values.len();
        places.max_by(|a, b| values[*a].abs().total_cmp(&values[*b].abs())).unwrap_or(0)
    };
    let (at, worst) = (largest(&misfits), largest(&logs));
    let inside = |misfits: &[f64], deviations: &[f64], own: f64| {
        let noise = scatter(misfits).0.hypot(own);
        let within = |(misfit, sd): &(&f64, &f64)| misfit.abs() <= NORMAL * sd.hypot(noise);
        let known = deviations.iter().all(|sd| sd.is_finite());
        known.then(|| misfits.iter().zip(deviations).filter(within).count() as f64 / misfits.len() as f64)
    };
    let own = (OWN * shift_of(points)).max(SHIFT_FLOOR * frequency[at]);
    Prediction {
        frequency_misfit: misfits[at],
        relative_frequency_misfit: misfits[at] / frequency[at],
        damping_misfit: logs[worst].exp_m1(),
        frequency_inside: inside(&misfits, &spread.frequency, own),
        damping_inside: inside(&logs, &spread.log_damping, OWN),
        not_predicted: spread.not_predicted.clone(),
    }
}
