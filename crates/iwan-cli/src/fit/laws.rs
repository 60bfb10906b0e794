//! Summaries of the laws that a fit compares with one Iwan joint.

use std::fmt::Write;

use iwan_ident::laws::{Backbone, CANDIDATES, Comparison, Estimate, FittedLaw};
use serde::Serialize;

use crate::page::numbers::{interval, long};

/// Name, in the table of laws, of the four-parameter Iwan joint that is fitted to the records.
pub(crate) const IWAN: &str = "iwan";

/// Name by which `--law` asks for the smooth curves in place of a law.
pub(crate) const BY_CURVES: &str = "curves";

/// Checks that a name is that of a law, or of the curves.
pub(crate) fn named(text: &str) -> Result<String, String> {
    let names = CANDIDATES.iter().map(|c| c.name).chain([BY_CURVES]);
    if names.clone().any(|name| name == text) {
        return Ok(text.to_string());
    }
    Err(format!("must be one of {}", names.collect::<Vec<_>>().join(", ")))
}

/// One law that was compared.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct LawSummary {
    pub(crate) name: &'static str,
    /// Twice the negative logarithm of the evidence, minus that of the best law: 0 for the best, larger for worse.
    pub(crate) criterion: f64,
    pub(crate) dissipation_misfit: f64,
    pub(crate) frequency_misfit: f64,
    /// Root-mean-square misfits of ln D and of the frequency (Hz) over thirds of the amplitudes, each third predicted by the law as fitted to the other
    /// two; null where the records cover too few amplitudes.
    pub(crate) held_out_dissipation: Option<f64>,
    pub(crate) held_out_frequency: Option<f64>,
    /// Standard deviation of the law's own error in dissipation beside the noise, relative, as estimated in the fit, …
    pub(crate) dissipation_discrepancy: f64,
    /// … and standard deviation of its error in frequency, Hz.
    pub(crate) frequency_discrepancy: f64,
    pub(crate) grade: &'static str,
    pub(crate) parameters: Vec<ParameterSummary>,
}

/// A parameter of a law with its 95 % interval; null is an open end.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct ParameterSummary {
    pub(crate) name: &'static str,
    pub(crate) value: f64,
    pub(crate) low: Option<f64>,
    pub(crate) high: Option<f64>,
}

/// Smooth curves of frequency and damping ratio against amplitude, with bands.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct BackboneSummary {
    pub(crate) amplitude: Vec<f64>,
    pub(crate) frequency: Vec<f64>,
    pub(crate) damping_ratio: Vec<f64>,
    pub(crate) frequency_low: Vec<f64>,
    pub(crate) frequency_high: Vec<f64>,
    pub(crate) damping_ratio_low: Vec<f64>,
    pub(crate) damping_ratio_high: Vec<f64>,
    /// How far hits differ from each other; null where there is one hit only.
    pub(crate) scatter: Option<ScatterSummary>,
}

/// Standard deviations of a single hit from the mean of the structure, both relative.
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

    /// The parameters as text, with their intervals.
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

/// Appends the table of laws for the terminal, best first, and the parameters of the chosen law where it is not the joint shown above. Writing to a
/// string cannot fail.
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

/// A root-mean-square misfit of ln D in per cent. From 100 % on the law predicts nothing, and the text says only that.
pub(crate) fn percent(misfit: f64) -> String {
    if misfit < 1.0 { format!("{:.2}", 100.0 * misfit) } else { "> 100".into() }
}

/// The laws, best first.
pub(crate) fn ranked(laws: &[LawSummary]) -> Vec<&LawSummary> {
    let mut all: Vec<&LawSummary> = laws.iter().collect();
    all.sort_by(|a, b| a.criterion.total_cmp(&b.criterion));
    all
}
