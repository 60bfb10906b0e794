//! The summary of an update: `update.json`, `summary.json` and the table on the terminal.

use std::fmt::Write;

use iwan_study::update::{
    ComparedBlow, ComparedCurve, Estimated, JointUpdate, LinearCorrection, NextMode, Prediction,
    StructureVerdict, Told, TradeOff, Update,
};
use serde::Serialize;

use crate::page::numbers::{interval, long};
use crate::session::{Summary, Warnings};
use crate::structures::Linear;

/// An estimate with the name of its quantity.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct NamedEstimate {
    pub(crate) name: String,
    #[serde(flatten)]
    pub(crate) estimate: Estimated,
}

/// A prediction with the mode and the file with which it is compared.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct NamedPrediction {
    pub(crate) mode: String,
    pub(crate) source: String,
    #[serde(flatten)]
    pub(crate) prediction: Prediction,
}

impl NamedPrediction {
    /// How far the prediction is from the measurement, and whether the band covers the difference, in words.
    pub(crate) fn in_words(&self) -> String {
        let p = &self.prediction;
        let band = |inside: Option<f64>| {
            inside.map_or_else(
                || "there is no band".into(),
                |share| format!("{:.0} % of the amplitudes lie in the 95 % band", 100.0 * share),
            )
        };
        format!(
            "predicted {} ({}): the frequency is missed by at most {:.4} Hz ({:.4} %), {}; the damping ratio is missed by at most {:.1} %, {}",
            self.mode,
            self.source,
            p.frequency_misfit.abs(),
            100.0 * p.relative_frequency_misfit.abs(),
            band(p.frequency_inside),
            100.0 * p.damping_misfit.abs(),
            band(p.damping_inside)
        )
    }
}

/// The joints that were found, and what is known about them.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct UpdateSummary {
    pub(crate) structure: String,
    /// Parameters of each group of joints.
    pub(crate) groups: Vec<JointUpdate>,
    /// Factors on parts of the linear stiffness.
    pub(crate) factors: Vec<NamedEstimate>,
    /// Viscous damping ratio of each measured mode.
    pub(crate) viscous: Vec<NamedEstimate>,
    pub(crate) verdict: StructureVerdict,
    /// Corrections of the linear stiffness that would explain the misfit.
    pub(crate) corrections: Vec<LinearCorrection>,
    /// Combinations of unknowns, those that the data determine best first.
    pub(crate) told: Vec<Told>,
    /// Modes whose measurement would add most information.
    pub(crate) next_modes: Vec<NextMode>,
    /// The advice on what to measure next in words, also where no mode is named. Empty without curves.
    pub(crate) measure_next: String,
    /// Predictions of the curves that were kept out of the fit.
    pub(crate) predictions: Vec<NamedPrediction>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) front: Option<Vec<TradeOff>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) curves: Option<Vec<ComparedCurve>>,
    /// Measured blows beside those of the structure; none without blows.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) blows: Option<Vec<ComparedBlow>>,
    pub(crate) warnings: Warnings,
}

/// The parameters of a group of joints, with their names.
pub(super) fn parameters(group: &JointUpdate) -> [(&'static str, Estimated); 4] {
    [("K_T", group.k_t), ("F_S", group.f_s), ("chi", group.chi), ("beta", group.beta)]
}

impl UpdateSummary {
    /// Makes the summary of an update.
    pub(super) fn new(linear: &Linear, found: &Update) -> Self {
        let named = |all: &[(String, Estimated)]| -> Vec<NamedEstimate> {
            all.iter()
                .map(|(name, estimate)| NamedEstimate { name: name.clone(), estimate: *estimate })
                .collect()
        };
        let mut warnings = Vec::new();
        let verdict = &found.verdict;
        if !(verdict.adequate && verdict.systematic.is_empty() && verdict.hints.is_empty()) {
            warnings.push(found.verdict.in_words.clone());
        }
        warnings.extend(found.corrections.iter().map(|c| {
            let rest = 100.0 * c.remaining;
            let then = if c.adequate { "tells all curves" } else { "comes nearer" };
            format!("with a factor of {:.4} on the stiffness of {} the structure {then}: {rest:.0} % of the misfit is left", c.factor, c.name)
        }));
        let predictions: Vec<NamedPrediction> = found
            .curves
            .iter()
            .filter_map(|curve| {
                let (mode, source) = (curve.mode.clone(), curve.source.clone());
                curve.prediction.clone().map(|prediction| NamedPrediction { mode, source, prediction })
            })
            .collect();
        warnings.extend(predictions.iter().flat_map(|p| p.prediction.not_predicted.iter().cloned()));
        if !found.converged {
            warnings.push("the search did not settle: the values may not be the best".into());
        }
        for group in &found.groups {
            let open: Vec<&str> = parameters(group)
                .into_iter()
                .filter(|(_, e)| !e.identifiable)
                .map(|(name, _)| name)
                .collect();
            if !open.is_empty() {
                warnings.push(format!(
                    "{}: the {} do not bound {}",
                    group.name,
                    if found.blows.is_empty() { "curves" } else { "blows" },
                    open.join(", ")
                ));
            }
        }
        Self {
            structure: linear.file.title.clone().unwrap_or_else(|| linear.source.clone()),
            groups: found.groups.clone(),
            factors: named(&found.factors),
            viscous: named(&found.viscous),
            verdict: found.verdict.clone(),
            corrections: found.corrections.clone(),
            told: found.told.clone(),
            next_modes: found.next_modes.clone(),
            measure_next: found.measure_next.clone(),
            predictions,
            front: Some(found.front.clone()),
            curves: Some(found.curves.clone()),
            blows: (!found.blows.is_empty()).then(|| found.blows.clone()),
            warnings: warnings.into_iter().collect(),
        }
    }

    /// The summary without the long lists.
    pub(super) fn without_curves(&self) -> Self {
        Self { front: None, curves: None, blows: None, ..self.clone() }
    }
}

impl Summary for UpdateSummary {
    fn warnings(&self) -> &[String] {
        &self.warnings
    }

    fn text(&self) -> String {
        let mut text = format!("{:<32}{:<14}{:>14}  95 % interval\n", "group", "parameter", "value");
        // Writing to a string cannot fail.
        let mut line = |group: &str, name: &str, e: &Estimated| {
            let _ = writeln!(text, "{group:<32}{name:<14}{:>14}  {}", long(e.value), interval(e.low, e.high));
        };
        for group in &self.groups {
            for (name, e) in &parameters(group) {
                line(&group.name, name, e);
            }
        }
        self.factors.iter().for_each(|f| line(&f.name, "factor", &f.estimate));
        self.viscous.iter().for_each(|v| line(&v.name, "damping ratio", &v.estimate));
        let _ = writeln!(text, "{}", self.verdict.in_words);
        for prediction in &self.predictions {
            let _ = writeln!(text, "{}", prediction.in_words());
        }
        if !self.measure_next.is_empty() {
            let _ = writeln!(text, "{}", self.measure_next);
        }
        text
    }
}
