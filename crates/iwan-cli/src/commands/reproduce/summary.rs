//! `reproduce.json`: every number of the report.

use std::path::PathBuf;

use serde::Serialize;
use serde_json::Value;

use super::Reproduction;
use super::counterpart::{Counterpart, Distance, Interval};
use super::findings::Finding;
use super::lab::LabSummary;
use super::modal::{Coupling, Reading, Slopes, Study};
use super::printed::{Joint, TABLE_1, TABLE_2};
use super::truth::{Filter, LEVELS, Side};

/// Everything that was found.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Summary {
    /// Version of iwan.
    pub(crate) version: &'static str,
    /// Of the truth and modal side, and of the laboratory.
    pub(crate) units: [&'static str; 2],
    pub(crate) table_1: Table1,
    pub(crate) table_2: Vec<Row2>,
    pub(crate) table_3: Vec<Row3>,
    pub(crate) table_4: Value,
    /// One entry per configuration.
    pub(crate) truth: Vec<Truth>,
    pub(crate) lab: LabSummary,
    pub(crate) findings: Vec<Finding>,
    /// The figures, whose data are in figures.json.
    pub(crate) figures: Vec<FigureEntry>,
    /// Names of the files.
    pub(crate) files: Vec<String>,
    /// Where they are: on standard output only, so that the folder may be moved.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) folder: Option<PathBuf>,
    /// Wall-clock time, s: on standard output only, so that the file is the same every time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) seconds: Option<f64>,
}

/// The discrete joint as printed and what follows from it.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Table1 {
    pub(crate) k_t: f64,
    pub(crate) f_s: f64,
    pub(crate) chi: f64,
    pub(crate) beta: f64,
    pub(crate) phi_max: f64,
    pub(crate) r: f64,
    pub(crate) s: f64,
    /// At the onset of macro-slip.
    pub(crate) dissipation_at_phi_max: f64,
}

/// A mode's parameters: printed, fitted, with intervals.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Row2 {
    pub(crate) configuration: &'static str,
    pub(crate) mode: String,
    pub(crate) printed: Parameters,
    /// None for a mode without joint.
    pub(crate) identified: Option<Parameters>,
    /// χ read off the slope as in Sec. 2.5, and F_S of the static plateau.
    pub(crate) graphical_chi: Option<f64>,
    pub(crate) static_f_s: Option<f64>,
    pub(crate) intervals: Vec<Interval>,
    pub(crate) adequate: Option<bool>,
    pub(crate) verdict: String,
}

/// Four parameters.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct Parameters {
    pub(crate) k_t: f64,
    pub(crate) f_s: f64,
    pub(crate) chi: f64,
    pub(crate) beta: f64,
}

impl From<Joint> for Parameters {
    fn from(Joint { k_t, f_s, chi, beta }: Joint) -> Self {
        Self { k_t, f_s, chi, beta }
    }
}

/// Frequency and viscous damping of a mode in the laboratory.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Row3 {
    pub(crate) mode: String,
    /// Of the truth at small amplitude, Hz.
    pub(crate) frequency: f64,
    /// What the suspension takes.
    pub(crate) damping_ratio: f64,
    /// Not to hand.
    pub(crate) printed_frequency: Option<f64>,
    pub(crate) printed_damping_ratio: Option<f64>,
}

/// One configuration of the truth model.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Truth {
    pub(crate) configuration: &'static str,
    pub(crate) nodes: usize,
    pub(crate) unknowns: usize,
    pub(crate) total_mass: f64,
    pub(crate) zero_modes: ZeroModes,
    /// All elastic modes up to the highest shown, by name.
    pub(crate) frequencies: Vec<(String, f64)>,
    pub(crate) filters: Vec<Filter>,
    pub(crate) energy_error: f64,
    pub(crate) levels: Vec<LevelSummary>,
    /// Differences in the first 20 ms and over the whole record at 1000 lbf, where attachment vectors are left out.
    pub(crate) without_attachments: Vec<Distance>,
    /// Distances of the reduced from the full model over the first 20 ms: level, then bending mode.
    pub(crate) reduction_error: Vec<(f64, Vec<f64>)>,
    pub(crate) modes: Vec<ModeSummary>,
}

/// Zero modes with all joints stuck, and slipping.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct ZeroModes {
    pub(crate) stuck: usize,
    pub(crate) slipping: usize,
}

/// One blow.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct LevelSummary {
    pub(crate) force: f64,
    /// Of |q''|, per bending mode.
    pub(crate) peak_acceleration: Vec<f64>,
    pub(crate) slip_ratio: f64,
}

/// One bending mode.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct ModeSummary {
    pub(crate) name: String,
    pub(crate) frequency_stuck: f64,
    pub(crate) frequency_slipping: f64,
    pub(crate) mac: f64,
    pub(crate) k_t: f64,
    pub(crate) tip: f64,
    /// Whether slipping does not soften the mode.
    pub(crate) linear: bool,
    /// By level.
    pub(crate) readings: Vec<Vec<Reading>>,
    pub(crate) coupling: Vec<Coupling>,
    /// Dissipation of a ring-down in this mode alone over that of the static curves.
    pub(crate) alone: Option<Coupling>,
    pub(crate) slopes: Option<Slopes>,
    pub(crate) quasi_static: StaticPoints,
    pub(crate) static_fit: Option<Parameters>,
    pub(crate) figure_8: Vec<Distance>,
    pub(crate) figure_8_printed: Vec<Distance>,
}

/// Static curves at chosen displacements.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct StaticPoints {
    pub(crate) displacement: Vec<f64>,
    pub(crate) frequency: Vec<f64>,
    pub(crate) dissipation: Vec<f64>,
    pub(crate) joint_force: Vec<f64>,
}

/// A figure and where its data are.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct FigureEntry {
    pub(crate) id: String,
    pub(crate) title: String,
    /// Points per curve.
    pub(crate) points: Vec<(String, usize)>,
}

impl Summary {
    /// Of all that was computed; files and folder are filled in later.
    pub(crate) fn new(of: &Reproduction) -> Result<Self, iwan_core::Error> {
        let law = TABLE_1.law()?;
        let Joint { k_t, f_s, chi, beta } = TABLE_1;
        let phi_max = law.phi_max();
        let dissipation_at_phi_max = iwan_core::Backbone::dissipation(&law, phi_max);
        let table_1 = Table1 { k_t, f_s, chi, beta, phi_max, r: law.r(), s: law.s(), dissipation_at_phi_max };
        Ok(Self {
            version: env!("CARGO_PKG_VERSION"),
            units: [
                "lbf, in, s; modal quantities mass-normalised",
                "N, m, s; modal quantities mass-normalised",
            ],
            table_1,
            table_2: of.modes().map(row_2).collect(),
            table_3: of.lab.modes.clone(),
            table_4: serde_json::to_value(&of.lab.table_4).unwrap_or_default(),
            truth: of.sides.iter().zip(&of.studies).map(|(side, studies)| truth(side, studies)).collect(),
            lab: of.lab.summary(),
            findings: super::findings::findings(of)?,
            figures: Vec::new(),
            files: Vec::new(),
            folder: None,
            seconds: None,
        })
    }

    /// As JSON text.
    pub(crate) fn json(&self) -> String {
        // Numbers, texts and lists: serialisation cannot fail.
        let mut text = serde_json::to_string_pretty(self).unwrap_or_default();
        text.push('\n');
        text
    }
}

fn row_2((study, counterpart): (&Study, Option<&Counterpart>)) -> Row2 {
    let linear = || {
        format!(
            "K_T = {:.3e} is negative: slipping frees inertia and does not soften this mode; it is linear, and nothing is fitted",
            study.k_t
        )
    };
    let identified = counterpart.map(|c| {
        let p = &c.parameters;
        Parameters { k_t: p.k_t, f_s: p.f_s, chi: p.chi, beta: p.beta }
    });
    Row2 {
        configuration: study.configuration,
        mode: study.name.clone(),
        printed: TABLE_2[study.index].into(),
        identified,
        graphical_chi: study.slopes.as_ref().filter(|_| study.has_joint()).map(|s| s.chi),
        static_f_s: study.static_fit.map(|fit| fit.parameters.f_s),
        intervals: counterpart.map(|c| c.intervals.clone()).unwrap_or_default(),
        adequate: counterpart.map(|c| c.adequate),
        verdict: counterpart.map_or_else(linear, |c| c.misfit.clone()),
    }
}

fn peak(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |most: f64, x| most.max(x.abs()))
}

fn truth(side: &Side, studies: &[(Study, Option<Counterpart>)]) -> Truth {
    let linear = &side.linear;
    let level = |(force, response): (f64, &iwan_fem::StructureResponse)| LevelSummary {
        force,
        peak_acceleration: response.outputs.iter().map(|history| peak(&history.acceleration)).collect(),
        slip_ratio: response.slips.iter().fold(0.0, |most: f64, slip| most.max(slip.slip_ratio)),
    };
    let shown = linear.elastic.iter().take(8);
    let alone =
        side.modes_alone.outputs.iter().zip(&side.responses[3].outputs).map(|(alone, truth)| Distance {
            level: LEVELS[3],
            early: super::counterpart::distance(&alone.acceleration[..2001], &truth.acceleration[..2001]),
            whole: super::counterpart::distance(&alone.acceleration, &truth.acceleration),
        });
    Truth {
        configuration: side.name,
        nodes: linear.assembled.structure().mesh.positions.len(),
        unknowns: linear.assembled.unknowns(),
        total_mass: linear.assembled.total_mass(),
        zero_modes: ZeroModes { stuck: linear.stuck.zero_modes(), slipping: linear.slipping.zero_modes() },
        frequencies: shown.map(|mode| (mode.name.clone(), linear.frequency_stuck(mode))).collect(),
        filters: side.filters.clone(),
        energy_error: side.energy_error(),
        levels: LEVELS.into_iter().zip(&side.responses).map(level).collect(),
        without_attachments: alone.collect(),
        reduction_error: side.reduction.clone(),
        modes: studies.iter().map(|(study, counterpart)| mode(study, counterpart.as_ref())).collect(),
    }
}

fn mode(study: &Study, counterpart: Option<&Counterpart>) -> ModeSummary {
    let checked = &study.checked;
    let static_fit = study.static_fit.map(|fit| {
        let p = fit.parameters;
        Parameters { k_t: p.k_t, f_s: p.f_s, chi: p.chi, beta: p.beta }
    });
    ModeSummary {
        name: study.name.clone(),
        frequency_stuck: study.stuck,
        frequency_slipping: study.slipping,
        mac: study.mac,
        k_t: study.k_t,
        tip: study.tip.abs(),
        linear: !study.has_joint(),
        readings: study.spots.clone(),
        coupling: study.coupling.clone(),
        alone: study.alone,
        slopes: study.slopes.clone().filter(|_| study.has_joint()),
        quasi_static: StaticPoints {
            displacement: checked.displacement.clone(),
            frequency: checked.frequency.clone(),
            dissipation: checked.dissipation.clone(),
            joint_force: checked.joint_force.clone(),
        },
        static_fit,
        figure_8: counterpart.map(|c| c.errors.clone()).unwrap_or_default(),
        figure_8_printed: counterpart.map(|c| c.errors_printed.clone()).unwrap_or_default(),
    }
}
