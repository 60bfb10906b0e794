//! The results of an update.

use iwan_core::FourParameter;
use iwan_fem::Correction;
use serde::Serialize;

use super::explain::LinearCorrection;
use super::fitted::{Estimated, Fit, JointUpdate};
use super::further::{NextMode, PARAMETERS, TradeOff};
use super::predicted::Prediction;
use super::task::UpdateTask;
use super::verdict::StructureVerdict;

/// A measured curve and those of the structure before and after the update; all vectors have one entry per amplitude.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ComparedCurve {
    /// Name of the mode.
    pub mode: String,
    /// Origin of the curve.
    pub source: String,
    /// Whether the curve was kept out of the fit.
    pub held_out: bool,
    /// Amplitude of the modal displacement.
    pub displacement: Vec<f64>,
    /// Measured frequency, Hz, …
    pub frequency: Vec<f64>,
    /// … and damping ratio.
    pub damping_ratio: Vec<f64>,
    /// Frequency of the structure with the joints of its file, Hz.
    pub frequency_before: Vec<f64>,
    /// Damping ratio of the structure with the joints of its file.
    pub damping_ratio_before: Vec<f64>,
    /// Frequency of the structure with the joints found, Hz.
    pub frequency_after: Vec<f64>,
    /// Damping ratio of the structure with the joints found.
    pub damping_ratio_after: Vec<f64>,
    /// Standard deviation of the computed frequency, Hz, due to what the curves leave open; infinite (null in files) where nothing bounds it.
    pub frequency_sd: Vec<f64>,
    /// Standard deviation of the logarithm of the computed damping ratio, likewise.
    pub log_damping_sd: Vec<f64>,
    /// For a curve that was kept out: the difference of the prediction from it, and what cannot be predicted.
    pub prediction: Option<Prediction>,
}

/// One mode at one point under a blow: measured and computed amplitudes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ComparedBlow {
    /// Origin of the record.
    pub source: String,
    /// Point, by the name of the structure's output.
    pub point: String,
    /// Mode at whose frequency both were compared.
    pub mode: String,
    /// Whether the blow was kept out of the fit.
    pub held_out: bool,
    /// Relative misfit with the joints of the file: root mean square of the difference of complex amplitudes over that of the measured ones; none
    /// where no motion can be computed with these joints.
    pub before: Option<f64>,
    /// Relative misfit with the joints found.
    pub after: f64,
    /// Middle of each window, s.
    pub time: Vec<f64>,
    /// Measured amplitude in each window, in the unit of the record.
    pub measured: Vec<f64>,
    /// Amplitude of the structure with the joints found in each window, in the same unit.
    pub computed: Vec<f64>,
}

/// A combination of unknowns, and how well the data determine it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Told {
    /// Standard deviation along the combination; none where nothing determines it.
    pub deviation: Option<f64>,
    /// Largest terms of the combination, as in `0.8 ln k_t of link - 0.6 ln f_s of link`.
    pub combination: String,
}

/// All results of an update.
#[derive(Debug, Clone, PartialEq)]
pub struct Update {
    /// The groups of joints.
    pub groups: Vec<JointUpdate>,
    /// The law of each group.
    pub laws: Vec<FourParameter>,
    /// Factors on parts of the stiffness, by name.
    pub factors: Vec<(String, Estimated)>,
    /// Viscous damping ratios of the measured modes, by name.
    pub viscous: Vec<(String, Estimated)>,
    /// Measured curves, compared with those of the structure.
    pub curves: Vec<ComparedCurve>,
    /// Combinations of unknowns, the best determined first.
    pub told: Vec<Told>,
    /// Whether the structure describes the data.
    pub verdict: StructureVerdict,
    /// Where the structure does not describe the curves: linear corrections with which it would, or nearly.
    pub corrections: Vec<LinearCorrection>,
    /// Modes whose measurement would add most information.
    pub next_modes: Vec<NextMode>,
    /// The advice on what to measure next in words, also where no mode is named; empty without curves.
    pub measure_next: String,
    /// Compromises between frequency and damping.
    pub front: Vec<TradeOff>,
    /// Blows compared with those of the structure, where joints were found from blows: one entry for each blow, point and mode.
    pub blows: Vec<ComparedBlow>,
    /// Whether the search converged.
    pub converged: bool,
}

impl Update {
    /// The law of each joint, by the joint's index; `task` is the task of the update.
    #[must_use]
    pub fn laws_of_joints(&self, task: &UpdateTask<'_>) -> Vec<(usize, FourParameter)> {
        let groups = task.groups.iter().zip(&self.laws);
        groups.flat_map(|(group, law)| group.joints.iter().map(move |joint| (*joint, *law))).collect()
    }

    /// The factor on each part of the stiffness; `task` is the task of the update.
    #[must_use]
    pub fn factors_of_parts(&self, task: &UpdateTask<'_>) -> Vec<(Correction, f64)> {
        let parts = task.corrections.iter().zip(&self.factors);
        parts.map(|((_, part, _), (_, factor))| (*part, factor.value)).collect()
    }
}

/// Smallest share of a term, relative to the largest, with which it is named in a combination.
const NAMED: f64 = 0.2;
/// Most terms that are named.
const MOST_NAMED: usize = 4;

/// The combinations in words.
pub(super) fn told(fit: &Fit<'_>, names: &[String]) -> Vec<Told> {
    in_words(&fit.told, &fit.free, names)
}

/// Combinations of the unknowns `free` in words.
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
