//! What an update found.

use iwan_core::FourParameter;
use iwan_fem::Correction;
use serde::Serialize;

use super::explain::LinearCorrection;
use super::fitted::{Estimated, Fit, JointUpdate};
use super::further::{NextMode, PARAMETERS, TradeOff};
use super::predicted::Prediction;
use super::task::UpdateTask;
use super::verdict::StructureVerdict;

/// A curve beside the structure's, before and after; one entry per amplitude.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ComparedCurve {
    /// Mode.
    pub mode: String,
    /// Where the curve comes from.
    pub source: String,
    /// Whether it was kept out of the fit.
    pub held_out: bool,
    /// Modal displacement.
    pub displacement: Vec<f64>,
    /// Measured frequency, Hz, …
    pub frequency: Vec<f64>,
    /// … and damping ratio.
    pub damping_ratio: Vec<f64>,
    /// Of the structure with the joints of its file.
    pub frequency_before: Vec<f64>,
    /// The same for the damping ratio.
    pub damping_ratio_before: Vec<f64>,
    /// With the joints found.
    pub frequency_after: Vec<f64>,
    /// The same for the damping ratio.
    pub damping_ratio_after: Vec<f64>,
    /// Standard deviation of the frequency found, Hz, by what the curves leave open; infinite (null in files) where nothing bounds it.
    pub frequency_sd: Vec<f64>,
    /// The same for ln ζ.
    pub log_damping_sd: Vec<f64>,
    /// Of a curve that was kept out: how far the prediction is off, and what cannot be predicted.
    pub prediction: Option<Prediction>,
}

/// One mode at one point under a blow: how far the structure is from what was measured.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ComparedBlow {
    /// Where the record comes from.
    pub source: String,
    /// Point, by the name of the structure's output.
    pub point: String,
    /// Mode about whose frequency both were compared.
    pub mode: String,
    /// Whether the blow was kept out of the fit.
    pub held_out: bool,
    /// Root mean square of the difference of complex amplitudes over that of the measured ones, with the joints of the file; none where these have no
    /// motion.
    pub before: Option<f64>,
    /// The same with the joints found.
    pub after: f64,
    /// Middles of the windows, s.
    pub time: Vec<f64>,
    /// Measured amplitude in each window, in the unit of the record.
    pub measured: Vec<f64>,
    /// That of the structure with the joints found.
    pub computed: Vec<f64>,
}

/// A combination of unknowns, and how well the curves tell it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Told {
    /// Standard deviation along it; none where nothing tells it.
    pub deviation: Option<f64>,
    /// Its largest terms, as `0.8 ln k_t of link - 0.6 ln f_s of link`.
    pub combination: String,
}

/// All that an update found.
#[derive(Debug, Clone, PartialEq)]
pub struct Update {
    /// The groups of joints.
    pub groups: Vec<JointUpdate>,
    /// Their laws.
    pub laws: Vec<FourParameter>,
    /// Factors on parts of the stiffness by name.
    pub factors: Vec<(String, Estimated)>,
    /// Viscous damping ratios of the measured modes.
    pub viscous: Vec<(String, Estimated)>,
    /// Measured curves beside the structure's.
    pub curves: Vec<ComparedCurve>,
    /// What the curves tell, best first.
    pub told: Vec<Told>,
    /// Whether the structure tells the curves.
    pub verdict: StructureVerdict,
    /// Where it does not: linear corrections with which it would, or nearly.
    pub corrections: Vec<LinearCorrection>,
    /// What to measure next.
    pub next_modes: Vec<NextMode>,
    /// That in words, where there are curves: also why no mode is named.
    pub measure_next: String,
    /// Compromises of frequency and damping.
    pub front: Vec<TradeOff>,
    /// Blows beside the structure's, where joints were found from blows: one entry for each point and mode of each.
    pub blows: Vec<ComparedBlow>,
    /// Whether the search ended by itself.
    pub converged: bool,
}

impl Update {
    /// The laws by the numbers of the joints; `task` is what was asked.
    #[must_use]
    pub fn laws_of_joints(&self, task: &UpdateTask<'_>) -> Vec<(usize, FourParameter)> {
        let groups = task.groups.iter().zip(&self.laws);
        groups.flat_map(|(group, law)| group.joints.iter().map(move |joint| (*joint, *law))).collect()
    }

    /// The factors by the part of the stiffness.
    #[must_use]
    pub fn factors_of_parts(&self, task: &UpdateTask<'_>) -> Vec<(Correction, f64)> {
        let parts = task.corrections.iter().zip(&self.factors);
        parts.map(|((_, part, _), (_, factor))| (*part, factor.value)).collect()
    }
}

/// Terms of a combination that are named: the others have less than this part of the largest.
const NAMED: f64 = 0.2;
/// Terms named at most.
const MOST_NAMED: usize = 4;

/// The combinations in words.
pub(super) fn told(fit: &Fit<'_>, names: &[String]) -> Vec<Told> {
    in_words(&fit.told, &fit.free, names)
}

/// Combinations of these free unknowns in words.
pub(super) fn in_words(told: &iwan_ident::estimate::Told, free: &[usize], names: &[String]) -> Vec<Told> {
    let in_words = |direction: &[f64]| {
        let mut terms: Vec<(f64, &String)> =
            direction.iter().copied().zip(free.iter().map(|j| &names[*j])).collect();
        terms.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));
        let least = NAMED * terms.first().map_or(0.0, |t| t.0.abs());
        let sign = terms.first().map_or(1.0, |t| t.0.signum());
        let shown = terms.into_iter().filter(|t| t.0.abs() >= least).take(MOST_NAMED);
        let mut text = String::new();
        for (weight, name) in shown {
            let weight = sign * weight;
            let joint = match (text.is_empty(), weight < 0.0) {
                (true, _) => "",
                (false, true) => " - ",
                (false, false) => " + ",
            };
            text = format!("{text}{joint}{:.2} {name}", weight.abs());
        }
        text
    };
    let one = |c: &iwan_ident::estimate::Combination| Told {
        deviation: Some(c.deviation).filter(|d| d.is_finite()),
        combination: in_words(&c.direction),
    };
    told.combinations().iter().map(one).collect()
}

/// Names of all coordinates.
pub(super) fn names(groups: &[String], factors: &[String], modes: &[String]) -> Vec<String> {
    let of_group = |group: &String| {
        let one = |(k, parameter): (usize, &&str)| match k {
            0 | 1 => format!("ln {parameter} of {group}"),
            2 => format!("{parameter} of {group}"),
            _ => format!("beta/(1+beta) of {group}"),
        };
        PARAMETERS.iter().enumerate().map(one).collect::<Vec<_>>()
    };
    let factor = |name: &String| format!("ln factor of {name}");
    let viscous = |name: &String| format!("damping ratio (0.1 %) of {name}");
    groups
        .iter()
        .flat_map(of_group)
        .chain(factors.iter().map(factor))
        .chain(modes.iter().map(viscous))
        .collect()
}
