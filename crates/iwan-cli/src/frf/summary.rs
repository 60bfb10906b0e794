//! The summary of `iwan frf`: `frf.json` and the table on the terminal.

use std::fmt::Write;

use iwan_input::scenario::SweepTable;
use iwan_sim::{SteadyCurve, Superharmonic};
use serde::Serialize;

use super::responses::Response;
use crate::page::numbers::{long, short};
use crate::session::{Summary, Warnings};

/// A peak that exceeds the largest amplitude of the records by less than this part counts as equal to it.
const ROUNDING: f64 = 1e-3;

/// The summary of steady forced responses.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct FrfSummary {
    /// The scenario's title, or its name.
    pub(crate) scenario: String,
    /// What is held: force, base_acceleration, displacement, velocity or acceleration.
    pub(crate) held: &'static str,
    /// Name of the output point; none where the response is the modal displacement.
    pub(crate) at: Option<String>,
    /// The highest harmonic.
    pub(crate) harmonics: usize,
    /// One entry per mode.
    pub(crate) modes: Vec<ModePeaks>,
    /// What the user should look at.
    pub(crate) warnings: Warnings,
    /// Wall-clock time of the computation, s.
    #[serde(skip)]
    pub(crate) seconds: f64,
}

/// The peaks of one mode.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct ModePeaks {
    pub(crate) name: String,
    /// Frequency at small amplitude, Hz; none for a structure with all its modes.
    pub(crate) frequency: Option<f64>,
    /// Range of the response's amplitude in the records from which the mode was identified; none where the scenario does not say.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) informed: Option<Informed>,
    /// One entry per level.
    pub(crate) levels: Vec<LevelPeak>,
}

/// A range of amplitudes.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct Informed {
    pub(crate) from: f64,
    pub(crate) to: f64,
}

/// The response at one level.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct LevelPeak {
    pub(crate) level: f64,
    /// The resonance peak; none where the curve has no points.
    pub(crate) peak: Option<Peak>,
    /// Points where the curve turns back in frequency: a measured response jumps there.
    pub(crate) jumps: Vec<Turn>,
    /// Points where a higher harmonic is in resonance with a mode.
    pub(crate) superharmonics: Vec<Overtone>,
    pub(crate) points: usize,
}

/// A resonance.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct Peak {
    /// Frequency, Hz.
    pub(crate) frequency: f64,
    pub(crate) amplitude: f64,
    /// Phase against the excitation, rad.
    pub(crate) phase: f64,
    /// Amplitude of the force, or of the base acceleration.
    pub(crate) excitation: f64,
}

/// A point at which a curve turns back in frequency.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct Turn {
    /// Frequency, Hz.
    pub(crate) frequency: f64,
    pub(crate) amplitude: f64,
}

/// A superharmonic resonance.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct Overtone {
    pub(crate) harmonic: usize,
    /// Frequency of the excitation, Hz.
    pub(crate) frequency: f64,
    /// Amplitude of the harmonic.
    pub(crate) amplitude: f64,
}

impl LevelPeak {
    fn new(curve: &SteadyCurve) -> Self {
        let peak = curve.peak().map(|p| Peak {
            frequency: p.frequency,
            amplitude: p.amplitude,
            phase: p.phase,
            excitation: p.excitation,
        });
        let turn = |jump: iwan_sim::Jump| Turn { frequency: jump.frequency, amplitude: jump.amplitude };
        let jumps = curve.jumps().into_iter().map(turn).collect();
        let overtone = |s: Superharmonic| Overtone {
            harmonic: s.harmonic,
            frequency: s.frequency,
            amplitude: s.amplitude,
        };
        let superharmonics = curve.superharmonics().into_iter().map(overtone).collect();
        Self { level: curve.level, peak, jumps, superharmonics, points: curve.points.len() }
    }
}

impl FrfSummary {
    /// Makes the summary of the responses to a sweep.
    pub(super) fn new(scenario: String, table: &SweepTable, responses: &[Response], seconds: f64) -> Self {
        let peaks = |response: &Response| ModePeaks {
            name: response.name.clone(),
            frequency: response.frequency,
            informed: response.informed.map(|[from, to]| Informed { from, to }),
            levels: response.curves.iter().map(LevelPeak::new).collect(),
        };
        let warning = |curve: &SteadyCurve| {
            let held = format!("{} {}: ", curve.control.name(), short(curve.level));
            curve.remarks.iter().map(|remark| format!("{held}{remark}")).collect::<Vec<_>>()
        };
        Self {
            scenario,
            held: table.sweep.control.name(),
            at: table.at.clone(),
            harmonics: table.sweep.harmonics,
            modes: responses.iter().map(peaks).collect(),
            warnings: responses
                .iter()
                .flat_map(|r| r.curves.iter().flat_map(warning).chain(beyond(r)))
                .collect(),
            seconds,
        }
    }
}

/// A warning where peaks exceed the amplitudes of the records from which the mode was identified; none otherwise.
fn beyond(response: &Response) -> Option<String> {
    let [_, to] = response.informed?;
    let above =
        |curve: &&SteadyCurve| curve.peak().is_some_and(|peak| peak.amplitude > to * (1.0 + ROUNDING));
    let levels: Vec<String> = response.curves.iter().filter(above).map(|curve| short(curve.level)).collect();
    let first = response.curves.iter().find(above)?;
    (!levels.is_empty()).then(|| {
        format!(
            "{}: beyond the amplitude {} the prediction leaves what the records informed: {} {}",
            response.name,
            short(to),
            first.control.name().replace('_', " "),
            levels.join(", ")
        )
    })
}

impl Summary for FrfSummary {
    fn warnings(&self) -> &[String] {
        &self.warnings
    }

    fn seconds(&self) -> Option<f64> {
        Some(self.seconds)
    }

    fn text(&self) -> String {
        let mut text = format!(
            "{:<16}{:>18}{:>14}{:>13}{:>13}{:>14}{:>7}\n",
            "mode", self.held, "resonance, Hz", "amplitude", "phase, deg", "excitation", "jumps"
        );
        for mode in &self.modes {
            for level in &mode.levels {
                let Some(peak) = level.peak else { continue };
                // Writing to a string cannot fail.
                let _ = writeln!(
                    text,
                    "{:<16}{:>18}{:>14}{:>13}{:>13.2}{:>14}{:>7}",
                    mode.name,
                    short(level.level),
                    long(peak.frequency),
                    short(peak.amplitude),
                    peak.phase.to_degrees(),
                    short(peak.excitation),
                    level.jumps.len()
                );
            }
        }
        for mode in &self.modes {
            for level in &mode.levels {
                for Overtone { harmonic, frequency, amplitude } in &level.superharmonics {
                    let _ = writeln!(
                        text,
                        "{}: at {} {} harmonic {harmonic} is in resonance at {} Hz, with the amplitude {}",
                        mode.name,
                        self.held.replace('_', " "),
                        short(level.level),
                        long(*frequency),
                        short(*amplitude)
                    );
                }
            }
        }
        text
    }
}
