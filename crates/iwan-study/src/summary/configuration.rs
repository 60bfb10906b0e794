//! One configuration of the beam and its modes, as numbers.

use iwan_fem::{ModalCurves, StructureResponse};
use serde::Serialize;

use super::tables::JointParameters;
use crate::beam::{BeamUnderBlows, FULL, FilterQuality, ReductionError, WITHOUT_ATTACHMENTS, letter};
use crate::blows::LEVELS;
use crate::modes::{Coupling, Distance, Reading, Slopes, StudiedMode};
use crate::relative_difference::relative_difference;
use crate::reproduction::StudiedBeam;

/// Number of elastic modes that are listed with their frequencies: up to the highest that the paper mentions, and a few more.
const LISTED: usize = 8;

/// One configuration of the truth model.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ConfigurationSummary {
    /// `A` or `B`.
    pub configuration: &'static str,
    /// Nodes of the mesh.
    pub nodes: usize,
    /// Unknowns of the full model.
    pub unknowns: usize,
    /// Mass, lbf·s²/in.
    pub total_mass: f64,
    /// Numbers of zero modes: rigid motions and, with all joints slipping, parts that can slide away.
    pub zero_modes: ZeroModes,
    /// The lowest elastic modes with all joints stuck.
    pub frequencies: Vec<NamedFrequency>,
    /// Rank and condition of modal filters for the modes of the reduced beam.
    pub filters: Vec<FilterQuality>,
    /// Largest error of the energy balance over all blows, relative.
    pub energy_error: f64,
    /// One entry for each blow.
    pub levels: Vec<LevelSummary>,
    /// Differences at 1000 lbf between the models without and with attachment vectors, by bending mode, over the first 20 ms and over the whole
    /// record.
    pub without_attachments: Vec<Distance>,
    /// Differences of the reduced model from the full one.
    pub reduction_error: Vec<ReductionError>,
    /// Bending modes 1 to 3.
    pub modes: Vec<ModeSummary>,
}

/// Numbers of zero modes in both limits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct ZeroModes {
    /// Number with all joints stuck: the rigid motions.
    pub stuck: usize,
    /// Number with all joints slipping.
    pub slipping: usize,
}

/// A mode and its frequency.
///
/// Serialised as a pair.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(into = "(String, f64)")]
pub struct NamedFrequency {
    /// Name, such as `torsion 1`.
    pub name: String,
    /// Frequency with all joints stuck, Hz.
    pub frequency: f64,
}

impl From<NamedFrequency> for (String, f64) {
    fn from(NamedFrequency { name, frequency }: NamedFrequency) -> Self {
        (name, frequency)
    }
}

/// One blow.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LevelSummary {
    /// Peak force, lbf.
    pub force: f64,
    /// Largest |q''| of each bending mode, √(lbf·in)/s.
    pub peak_acceleration: Vec<f64>,
    /// Largest slip of all joints, over φ_max.
    pub slip_ratio: f64,
}

/// One bending mode.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModeSummary {
    /// Name, such as `bending 1`.
    pub name: String,
    /// Frequency with all joints stuck, Hz.
    pub frequency_stuck: f64,
    /// Frequency with all joints slipping, Hz.
    pub frequency_slipping: f64,
    /// Modal assurance criterion between the stuck and the slipping shape.
    pub mac: f64,
    /// K_T = ω0² - ω∞², 1/s².
    pub k_t: f64,
    /// Absolute value of the mass-normalised shape at the loaded edge.
    pub tip: f64,
    /// Whether the mode is linear, that is, not softened by slipping joints.
    pub linear: bool,
    /// Readings at each level, early, in the middle and late in the record.
    pub readings: Vec<Vec<Reading>>,
    /// Dissipation under an impact over that of the mode alone, at each level.
    pub coupling: Vec<Coupling>,
    /// Dissipation of a ring-down in this mode alone over that of the static curves.
    pub alone: Option<Coupling>,
    /// Straight lines through the dissipation in micro-slip; none for a mode without joint.
    pub slopes: Option<Slopes>,
    /// Static curves at the displacements for which an independent program has computed them, too.
    pub quasi_static: StaticPoints,
    /// The joint fitted to the static curves.
    pub static_fit: Option<JointParameters>,
    /// Difference of the fitted modal model from the truth, at each level.
    pub figure_8: Vec<Distance>,
    /// The same difference with the printed parameters.
    pub figure_8_printed: Vec<Distance>,
}

/// Static curves at chosen displacements.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StaticPoints {
    /// Amplitude of the displacement, √(lbf·in)·s.
    pub displacement: Vec<f64>,
    /// Frequency, Hz.
    pub frequency: Vec<f64>,
    /// Energy dissipated per cycle, lbf·in.
    pub dissipation: Vec<f64>,
    /// Modal joint force, √(lbf·in)/s.
    pub joint_force: Vec<f64>,
}

impl ConfigurationSummary {
    /// Makes the summary of a configuration and its modes.
    pub(super) fn new(studied: &StudiedBeam) -> Self {
        let truth = &studied.truth;
        let (modes, configuration) = (&truth.beam.modes, truth.beam.configuration);
        let named = modes
            .elastic
            .iter()
            .take(LISTED)
            .map(|mode| NamedFrequency { name: mode.name.clone(), frequency: modes.frequency_stuck(mode) });
        Self {
            configuration: letter(configuration),
            nodes: modes.assembled.structure().mesh.positions.len(),
            unknowns: modes.assembled.unknowns(),
            total_mass: modes.assembled.total_mass(),
            zero_modes: ZeroModes { stuck: modes.stuck.zero_modes(), slipping: modes.slipping.zero_modes() },
            frequencies: named.collect(),
            filters: truth.filters.clone(),
            energy_error: truth.energy_error(),
            levels: LEVELS.into_iter().zip(&truth.responses).map(level).collect(),
            without_attachments: without_attachments(truth),
            reduction_error: truth.reduction.clone(),
            modes: studied.modes.iter().map(ModeSummary::new).collect(),
        }
    }
}

fn peak(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |most: f64, x| most.max(x.abs()))
}

fn level((force, response): (f64, &StructureResponse)) -> LevelSummary {
    LevelSummary {
        force,
        peak_acceleration: response.outputs.iter().map(|history| peak(&history.acceleration)).collect(),
        slip_ratio: response.slips.iter().fold(0.0, |most: f64, slip| most.max(slip.slip_ratio)),
    }
}

fn without_attachments(truth: &BeamUnderBlows) -> Vec<Distance> {
    let with = &truth.responses[WITHOUT_ATTACHMENTS].outputs;
    let pairs = truth.without_attachments.outputs.iter().zip(with);
    let apart = pairs.map(|(without, with)| Distance {
        level: LEVELS[WITHOUT_ATTACHMENTS],
        early: relative_difference(&without.acceleration[..=FULL], &with.acceleration[..=FULL]),
        whole: relative_difference(&without.acceleration, &with.acceleration),
    });
    apart.collect()
}

impl From<&ModalCurves> for StaticPoints {
    fn from(curves: &ModalCurves) -> Self {
        Self {
            displacement: curves.displacement.clone(),
            frequency: curves.frequency.clone(),
            dissipation: curves.dissipation.clone(),
            joint_force: curves.joint_force.clone(),
        }
    }
}

impl ModeSummary {
    /// Makes the summary of a mode and its modal model.
    fn new(studied: &StudiedMode) -> Self {
        let StudiedMode { mode, counterpart } = studied;
        let counterpart = counterpart.as_ref();
        Self {
            name: mode.name.clone(),
            frequency_stuck: mode.stuck,
            frequency_slipping: mode.slipping,
            mac: mode.mac,
            k_t: mode.k_t,
            tip: mode.tip.abs(),
            linear: !mode.has_joint(),
            readings: mode.readings.clone(),
            coupling: mode.coupling.clone(),
            alone: mode.alone,
            slopes: mode.slopes.clone().filter(|_| mode.has_joint()),
            quasi_static: StaticPoints::from(&mode.checked),
            static_fit: mode.static_fit.map(|fit| fit.parameters.into()),
            figure_8: counterpart.map(|c| c.errors.clone()).unwrap_or_default(),
            figure_8_printed: counterpart.map(|c| c.errors_printed.clone()).unwrap_or_default(),
        }
    }
}
