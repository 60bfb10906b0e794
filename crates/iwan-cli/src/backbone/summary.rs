//! The summary of `iwan backbone`: `summary.json` and the table on the terminal.

use std::fmt::Write;

use serde::Serialize;

use super::curves::Traced;
use crate::page::numbers::{long, short};
use crate::session::{Summary, Warnings};

/// The summary of nonlinear modes.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct BackboneSummary {
    /// The scenario's title, or its name.
    pub(crate) scenario: String,
    /// The highest harmonic.
    pub(crate) harmonics: usize,
    /// One entry per mode.
    pub(crate) modes: Vec<ModeBackbone>,
    /// What the user should look at.
    pub(crate) warnings: Warnings,
    /// Wall-clock time of the computation, s.
    #[serde(skip)]
    pub(crate) seconds: f64,
}

/// The backbone of one mode.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct ModeBackbone {
    pub(crate) name: String,
    /// Amplitudes of the modal displacement, one per point.
    pub(crate) amplitude: Vec<f64>,
    /// Frequency at each amplitude, Hz.
    pub(crate) frequency: Vec<f64>,
    pub(crate) damping_ratio: Vec<f64>,
}

impl BackboneSummary {
    /// Makes the summary of the modes' backbones.
    pub(super) fn new(scenario: String, harmonics: usize, traced: &[Traced], seconds: f64) -> Self {
        let mode = |t: &Traced| ModeBackbone {
            name: t.name.clone(),
            amplitude: t.curve.points.iter().map(|p| p.amplitude).collect(),
            frequency: t.curve.points.iter().map(|p| p.frequency).collect(),
            damping_ratio: t.curve.points.iter().map(|p| p.damping_ratio).collect(),
        };
        let warning = |t: &Traced| {
            t.curve.remarks.iter().map(|remark| format!("{}: {remark}", t.name)).collect::<Vec<_>>()
        };
        let modes = traced.iter().map(mode).collect();
        Self { scenario, harmonics, modes, warnings: traced.iter().flat_map(warning).collect(), seconds }
    }
}

impl Summary for BackboneSummary {
    fn warnings(&self) -> &[String] {
        &self.warnings
    }

    fn seconds(&self) -> Option<f64> {
        Some(self.seconds)
    }

    fn text(&self) -> String {
        let mut text =
            format!("{:<16}{:>13}{:>16}{:>12}\n", "mode", "amplitude", "frequency, Hz", "damping, %");
        for mode in &self.modes {
            let last = mode.amplitude.len().saturating_sub(1);
            // The terminal shows both ends of a backbone and three points between them.
            let mut shown: Vec<usize> = (0..=4).map(|i| i * last / 4).collect();
            shown.dedup();
            for i in shown.into_iter().filter(|i| *i < mode.amplitude.len()) {
                // Writing to a string cannot fail.
                let _ = writeln!(
                    text,
                    "{:<16}{:>13}{:>16}{:>12}",
                    mode.name,
                    short(mode.amplitude[i]),
                    long(mode.frequency[i]),
                    short(100.0 * mode.damping_ratio[i])
                );
            }
        }
        text
    }
}
