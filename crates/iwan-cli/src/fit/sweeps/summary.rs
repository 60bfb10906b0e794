//! The summary of the fit of a shaker's test: `fit.json` and the text on the terminal.

use std::fmt::Write;

use iwan_ident::Parameter;
use iwan_ident::sweeps::{SteadyData, SteadyFit};
use serde::Serialize;

use super::measurement::Measurement;
use crate::fit::joint::{Estimate, JointFit};
use crate::page::numbers::short;
use crate::session::{Summary, Warnings};

/// The fit of one mode.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct SweepSummary {
    #[serde(skip)]
    pub(super) title: String,
    pub(super) records: Vec<String>,
    pub(super) measurements: Vec<MeasurementSummary>,
    /// The fitted mode, as a list of one.
    pub(super) modes: Vec<SteadyMode>,
    pub(super) warnings: Warnings,
}

/// One file of the test.
#[derive(Debug, Clone, Serialize)]
pub(super) struct MeasurementSummary {
    pub(super) file: String,
    /// `response` or `backbone`.
    pub(super) kind: &'static str,
    pub(super) points: usize,
    /// The quantity that was held, and below it the levels in the modal coordinate.
    pub(super) held: Option<&'static str>,
    pub(super) levels: Vec<f64>,
    /// Linear frequency in this measurement minus that of the reference, Hz.
    pub(super) drift: f64,
    /// Relative errors (standard deviations): of force and motion for a response, of frequency and damping for a backbone.
    pub(super) errors: [f64; 2],
}

/// The mode.
#[derive(Debug, Clone, Serialize)]
pub(super) struct SteadyMode {
    #[serde(flatten)]
    pub(super) joint: JointFit,
    /// Smallest and largest measured amplitude of the modal displacement.
    pub(super) informed: [f64; 2],
    /// Static flexibility of all other modes at the measured point, which adds to the response of the fitted mode.
    pub(super) other_modes: f64,
    pub(super) in_words: Vec<String>,
}

impl MeasurementSummary {
    fn new(measurement: &Measurement, n: usize, fit: &SteadyFit) -> Self {
        let held = || measurement.levels.iter().filter_map(|level| level.held);
        Self {
            file: measurement.file.clone(),
            kind: if matches!(measurement.data, SteadyData::Response(_)) { "response" } else { "backbone" },
            points: measurement.data.len(),
            held: held().next().map(|h| h.0.name()),
            levels: held().map(|h| h.1).collect(),
            drift: fit.parameters.frequency * fit.drifts[n].exp_m1(),
            errors: fit.errors[n],
        }
    }

    fn words(&self) -> String {
        let errors = match self.kind {
            "response" => format!("force and motion within {:.2} %", 100.0 * self.errors[0]),
            _ => format!(
                "frequency within {:.4} %, damping within {:.2} %",
                100.0 * self.errors[0],
                100.0 * self.errors[1]
            ),
        };
        format!("{}: {} points, {errors}, {:+.4} Hz on its day", self.file, self.points, self.drift)
    }
}

impl SweepSummary {
    /// Makes the summary of a fit to these measurements and records.
    pub(super) fn new(
        name: &str,
        records: Vec<String>,
        measurements: &[Measurement],
        fit: &SteadyFit,
    ) -> Self {
        let files: Vec<MeasurementSummary> =
            measurements.iter().enumerate().map(|(n, m)| MeasurementSummary::new(m, n, fit)).collect();
        let all: Vec<&str> =
            records.iter().map(String::as_str).chain(files.iter().map(|m| m.file.as_str())).collect();
        let title = format!("Fit of {}", all.join(", "));
        let mode = SteadyMode::new(name, fit, &files);
        let warnings = mode.joint.doubt("these measurements").into_iter().collect();
        Self { title, records, measurements: files, modes: vec![mode], warnings }
    }
}

impl SteadyMode {
    fn new(name: &str, fit: &SteadyFit, files: &[MeasurementSummary]) -> Self {
        let p = fit.parameters;
        let estimate = |parameter: Parameter| {
            let profile = fit.profiles.iter().find(|profile| profile.parameter == parameter);
            let open =
                Estimate { value: p.get(parameter), low: None, high: None, identifiable: false, held: false };
            profile.map_or(open, Estimate::new)
        };
        let informed = format!(
            "amplitudes of the modal displacement from {} to {} were measured: beyond, a prediction leaves what the \
             measurements informed",
            short(fit.informed[0]),
            short(fit.informed[1])
        );
        let micro = (!fit.slips).then(|| {
            "no macro-slip is seen: of K_T and F_S only the least is told, and beta is open".to_string()
        });
        let words = [fit.verdict.misfit.clone(), informed].into_iter().chain(micro);
        Self {
            joint: JointFit::new(name, &p, estimate, &fit.verdict, fit.informed[1]),
            informed: fit.informed,
            other_modes: fit.others,
            in_words: words.chain(files.iter().map(MeasurementSummary::words)).collect(),
        }
    }
}

impl Summary for SweepSummary {
    fn warnings(&self) -> &[String] {
        &self.warnings
    }

    fn text(&self) -> String {
        let mut text = String::new();
        for mode in &self.modes {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{}: {}\n", mode.joint.name, mode.joint.verdict());
            mode.joint.write(&mut text);
            for words in &mode.in_words {
                let _ = writeln!(text, "  {words}");
            }
        }
        text
    }
}
