//! Laws beside one Iwan joint, as a fit tells of them.

use std::fmt::Write;

use iwan_ident::laws::{Backbone, CANDIDATES, Comparison, Estimate, FittedLaw};
use serde::Serialize;

use crate::page::numbers::{interval, long};

/// Name of the curves where a law can be asked for.
pub(crate) const BY_CURVES: &str = "curves";

/// Whether a name is that of a law, or of the curves.
pub(crate) fn named(text: &str) -> Result<String, String> {
    let names = CANDIDATES.iter().map(|c| c.name).chain([BY_CURVES]);
    if names.clone().any(|name| name == text) {
        return Ok(text.to_string());
    }
    Err(format!("must be one of {}", names.collect::<Vec<_>>().join(", ")))
}

/// One law.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct LawSummary {
    pub(crate) name: &'static str,
    /// Twice the negative logarithm of the evidence, less that of the best.
    pub(crate) criterion: f64,
    pub(crate) dissipation_misfit: f64,
    pub(crate) frequency_misfit: f64,
    /// What it misses of thirds of the amplitudes that it was not fitted to, of ln D and Hz: null where the records saw too few.
    pub(crate) held_out_dissipation: Option<f64>,
    pub(crate) held_out_frequency: Option<f64>,
    /// What it misses beside noise, as estimated with it (standard deviations): of dissipation, relative, …
    pub(crate) dissipation_discrepancy: f64,
    /// … and of the frequency, Hz.
    pub(crate) frequency_discrepancy: f64,
    pub(crate) grade: &'static str,
    pub(crate) parameters: Vec<ParameterSummary>,
}

/// A parameter of a law with its 95 % interval: null is open.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct ParameterSummary {
    pub(crate) name: &'static str,
    pub(crate) value: f64,
    pub(crate) low: Option<f64>,
    pub(crate) high: Option<f64>,
}

/// Smooth curves with bands.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct BackboneSummary {
    pub(crate) amplitude: Vec<f64>,
    pub(crate) frequency: Vec<f64>,
    pub(crate) damping_ratio: Vec<f64>,
    pub(crate) frequency_low: Vec<f64>,
    pub(crate) frequency_high: Vec<f64>,
    pub(crate) damping_ratio_low: Vec<f64>,
    pub(crate) damping_ratio_high: Vec<f64>,
    /// How far hits stray from each other: null of one hit.
    pub(crate) scatter: Option<ScatterSummary>,
}

/// Standard deviations of one hit from the specimen's mean, both relative.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct ScatterSummary {
    pub(crate) hits: usize,
    pub(crate) damping_ratio: f64,
    pub(crate) frequency: f64,
}

impl LawSummary {
    pub(crate) fn all(found: &Comparison) -> Vec<Self> {
        found.laws.iter().map(Self::new).collect()
    }

    fn new(l: &FittedLaw) -> Self {
        Self {
            name: l.law.name,
            criterion: l.criterion,
            dissipation_misfit: l.dissipation_misfit,
            frequency_misfit: l.frequency_misfit,
            held_out_dissipation: l.held_out.map(|h| h.dissipation),
            held_out_frequency: l.held_out.map(|h| h.frequency),
            dissipation_discrepancy: l.discrepancy.0,
            frequency_discrepancy: l.discrepancy.1,
            grade: l.grade.name(),
            parameters: l.parameters.iter().map(ParameterSummary::new).collect(),
        }
    }

    /// Its parameters as text, with their intervals.
    pub(crate) fn values(&self) -> String {
        let one =
            |p: &ParameterSummary| format!("{} = {} ({})", p.name, long(p.value), interval(p.low, p.high));
        self.parameters.iter().map(one).collect::<Vec<_>>().join(", ")
    }
}

impl ParameterSummary {
    fn new(e: &Estimate) -> Self {
        Self { name: e.name, value: e.value, low: e.low, high: e.high }
    }
}

impl BackboneSummary {
    pub(crate) fn new(b: &Backbone) -> Self {
        Self {
            amplitude: b.amplitude.clone(),
            frequency: b.frequency.clone(),
            damping_ratio: b.damping_ratio.clone(),
            frequency_low: b.frequency_low.clone(),
            frequency_high: b.frequency_high.clone(),
            damping_ratio_low: b.damping_ratio_low.clone(),
            damping_ratio_high: b.damping_ratio_high.clone(),
            scatter: (b.scatter.hits > 1).then_some(ScatterSummary {
                hits: b.scatter.hits,
                damping_ratio: b.scatter.decay,
                frequency: b.scatter.frequency,
            }),
        }
    }
}

/// The laws as a table for the terminal, best first, and the parameters of the one to take where that is another one than the joint above. Writing to a string cannot fail.
pub(crate) fn write(laws: &[LawSummary], chosen: &str, text: &mut String) {
    if laws.is_empty() {
        return;
    }
    let _ = writeln!(
        text,
        "\n{:<28}{:>10}{:>15}{:>13}{:>14}   grade",
        "law", "criterion", "dissipation, %", "held out, %", "frequency, Hz"
    );
    for l in ranked(laws) {
        let (name, criterion, grade) = (l.name, l.criterion, l.grade);
        let (d, f) = (100.0 * l.dissipation_misfit, l.frequency_misfit);
        let held_out = l.held_out_dissipation.map_or("-".into(), percent);
        let _ = writeln!(text, "{name:<28}{criterion:>10.1}{d:>15.2}{held_out:>13}{f:>14.5}   {grade}");
    }
    if let Some(law) = laws.iter().find(|l| l.name == chosen && l.name != "iwan" && l.grade != "no") {
        let _ = writeln!(text, "\n{:<28}{:>14}   95 % interval", law.name, "value");
        for p in &law.parameters {
            let _ = writeln!(text, "{:<28}{:>14}   {}", p.name, long(p.value), interval(p.low, p.high));
        }
    }
}

/// A root-mean-square misfit of ln D in per cent; from 100 % on a law predicts nothing, and its digits would say nothing.
pub(crate) fn percent(misfit: f64) -> String {
    if misfit < 1.0 { format!("{:.2}", 100.0 * misfit) } else { "> 100".into() }
}

/// The laws, best first.
pub(crate) fn ranked(laws: &[LawSummary]) -> Vec<&LawSummary> {
    let mut all: Vec<&LawSummary> = laws.iter().collect();
    all.sort_by(|a, b| a.criterion.total_cmp(&b.criterion));
    all
}
