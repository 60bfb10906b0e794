//! The summary of a simulation: `summary.json`, the table on the terminal, and warnings in words.

use std::fmt::Write;

use iwan_core::{Backbone, EnergyBalance};
use iwan_input::scenario::Scenario;
use iwan_sim::{CoupledResponse, JointHistory, Method, Mode, Response, Totals};
use serde::Serialize;

use super::files::PointResponse;
use crate::page::numbers::{error, or_dash, short};
use crate::session::{Summary, Warnings};
use crate::structures::Size;

/// An estimated error above this part of the peak gets a warning, because it is visible in a figure. A matter of judgement; both errors of the
/// built-in scenario stay below 5e-4.
const LARGE_ERROR: f64 = 0.01;

/// Fewer samples per cycle than this get a warning: the period by average acceleration without prewarping is then wrong by (omega dt)^2/12 = 0.8 %,
/// and the damping read off the extremes of a linear decay by 2 %.
const COARSE: f64 = 20.0;

/// The summary of a simulation.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct SimulationSummary {
    /// The scenario's title, or its name.
    pub(crate) scenario: String,
    /// The method's name.
    pub(crate) method: &'static str,
    /// Time between samples, s.
    pub(crate) time_step: f64,
    /// Length of the response, s.
    pub(crate) duration: f64,
    /// One entry per mode.
    pub(crate) modes: Vec<ModeSummary>,
    /// One entry per named point.
    pub(crate) points: Vec<PointSummary>,
    /// The structure and its joints, where the scenario has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) structure: Option<StructureSummary>,
    /// The joints that modes share, where the scenario has some.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) coupled: Option<CoupledSummary>,
    /// What the user should look at.
    pub(crate) warnings: Warnings,
    /// Wall-clock time of all modes and error estimates together, s.
    pub(crate) seconds: f64,
}

/// What the summary of a run on a structure holds beside its modes.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct StructureSummary {
    pub(crate) title: String,
    pub(crate) size: Size,
    /// `reduced` or `full`.
    pub(crate) model: &'static str,
    /// Modes in the basis of the reduced model.
    pub(crate) basis: Option<usize>,
    /// Estimated relative error of the reduction, in the accelerations of the outputs; none where it was not estimated.
    pub(crate) basis_error: Option<f64>,
    /// Whether that error is within the tolerance.
    pub(crate) converged: Option<bool>,
    /// One entry per slip of a joint.
    pub(crate) slips: Vec<SlipSummary>,
}

/// The summary of one slip of a joint.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct SlipSummary {
    pub(crate) name: String,
    pub(crate) peak_slip: f64,
    pub(crate) peak_force: f64,
    /// Largest slip over the strength of the strongest slider.
    pub(crate) slip_ratio: f64,
}

impl StructureSummary {
    /// Warnings in words.
    pub(crate) fn warnings(&self) -> Vec<String> {
        let (Some(basis), Some(error), Some(false)) = (self.basis, self.basis_error, self.converged) else {
            return Vec::new();
        };
        vec![format!(
            "the reduction to {basis} modes is off by about {}, more than the tolerance: choose model = \"full\" or a larger tolerance",
            percent(error)
        )]
    }
}

/// What the summary of modes that share joints holds beside the modes.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct CoupledSummary {
    /// Relative error of the energy balance of all coupled modes and joints.
    pub(crate) energy_error: f64,
    /// The energy balance of all coupled modes and joints.
    pub(crate) energy: Energy,
    /// One entry per joint.
    pub(crate) joints: Vec<JointSummary>,
}

/// The summary of one joint.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct JointSummary {
    #[serde(flatten)]
    pub(crate) slip: SlipSummary,
    /// Energy dissipated by the joint's sliders.
    pub(crate) friction: f64,
    pub(crate) forgotten_force: f64,
}

impl JointSummary {
    fn new(joint: &JointHistory) -> Self {
        let slip = SlipSummary {
            name: joint.name.clone(),
            peak_slip: joint.peak_slip(),
            peak_force: joint.peak_force(),
            slip_ratio: joint.slip_ratio(),
        };
        Self { slip, friction: joint.friction, forgotten_force: joint.forgotten_force }
    }
}

impl CoupledSummary {
    /// Makes the summary of a response.
    pub(crate) fn new(response: &CoupledResponse) -> Self {
        Self {
            energy_error: response.energy.error(),
            energy: Energy::from(&response.energy),
            joints: response.joints.iter().map(JointSummary::new).collect(),
        }
    }

    /// Warnings in words.
    fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        if self.energy_error > LARGE_ERROR {
            warnings.push(format!(
                "the coupled modes leave {} of their energy unaccounted for: shorten step",
                percent(self.energy_error)
            ));
        }
        for joint in self.joints.iter().filter(|joint| joint.forgotten_force > 0.0) {
            warnings.push(format!(
                "joint \"{}\": reversals were forgotten for lack of room; its force is off by at most {:.3e}",
                joint.slip.name, joint.forgotten_force
            ));
        }
        warnings
    }
}

/// The summary of one mode, in modal units; errors are relative to the peak displacement.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct ModeSummary {
    pub(crate) name: String,
    /// Frequency at small amplitude, Hz.
    pub(crate) frequency: f64,
    /// Viscous damping ratio.
    pub(crate) damping_ratio: f64,
    /// Onset of macro-slip; none for a linear mode.
    pub(crate) phi_max: Option<f64>,
    pub(crate) peak_displacement: f64,
    pub(crate) peak_acceleration: f64,
    pub(crate) final_displacement: f64,
    pub(crate) slip_ratio: f64,
    pub(crate) energy_error: f64,
    pub(crate) time_step_error: Option<f64>,
    pub(crate) discretisation_error: Option<f64>,
    pub(crate) forgotten_force: f64,
    /// For a mode by curves (frequency and damping ratio tabulated against amplitude): the time from which on its amplitude stays below the curves'
    /// range, and, below, the time at which it first exceeds this range, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) below_curves_from: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) above_curves_from: Option<f64>,
    pub(crate) samples_per_cycle: f64,
    pub(crate) steps: usize,
    pub(crate) seconds: f64,
    pub(crate) energy: Energy,
}

/// The energy balance: initial + input = kinetic + elastic + stored + viscous + friction + residual.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct Energy {
    pub(crate) initial: f64,
    pub(crate) input: f64,
    pub(crate) kinetic: f64,
    pub(crate) elastic: f64,
    pub(crate) stored: f64,
    pub(crate) viscous: f64,
    pub(crate) friction: f64,
    pub(crate) residual: f64,
}

/// The summary of one named point.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct PointSummary {
    pub(crate) name: String,
    pub(crate) peak_displacement: f64,
    pub(crate) peak_velocity: f64,
    pub(crate) peak_acceleration: f64,
}

impl From<&EnergyBalance> for Energy {
    fn from(e: &EnergyBalance) -> Self {
        let EnergyBalance { initial, input, kinetic, elastic, stored, viscous, friction, residual, .. } = *e;
        Self { initial, input, kinetic, elastic, stored, viscous, friction, residual }
    }
}

/// The largest absolute value.
pub(super) fn peak(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, x| most.max(x.abs()))
}

impl ModeSummary {
    /// Makes the summary of a mode from its response.
    pub(crate) fn new(mode: &Mode, response: &Totals) -> Self {
        Self {
            name: mode.name.clone(),
            frequency: mode.frequency,
            damping_ratio: mode.damping_ratio,
            phi_max: mode.joint.as_ref().map(|law| law.strengths().1),
            peak_displacement: response.peak_displacement,
            peak_acceleration: response.peak_acceleration,
            final_displacement: response.final_displacement,
            slip_ratio: response.slip_ratio(),
            energy_error: response.energy.error(),
            time_step_error: response.quality.time_step_error,
            discretisation_error: response.quality.discretisation_error,
            forgotten_force: response.quality.forgotten_force,
            below_curves_from: response.quality.outside_curves.below_from,
            above_curves_from: response.quality.outside_curves.above_from,
            samples_per_cycle: 1.0 / (mode.frequency * response.dt),
            steps: response.steps,
            seconds: response.seconds,
            energy: Energy::from(&response.energy),
        }
    }

    /// Warnings in words.
    pub(crate) fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        let name = &self.name;
        if let Some(error) = self.time_step_error.filter(|e| *e > LARGE_ERROR) {
            warnings.push(format!(
                "mode \"{name}\": step and method contribute an error of about {} of the peak: shorten step or compare with another method",
                percent(error)
            ));
        }
        if let Some(error) = self.discretisation_error.filter(|e| *e > LARGE_ERROR) {
            warnings.push(format!(
                "mode \"{name}\": cutting the joint into sliders contributes an error of about {} of the peak: \
                 take more sliders or joint = \"continuum\"",
                percent(error)
            ));
        }
        if self.energy_error > LARGE_ERROR {
            warnings.push(format!(
                "mode \"{name}\": the method leaves {} of the energy unaccounted for: compare with another method",
                percent(self.energy_error)
            ));
        }
        if self.samples_per_cycle < COARSE {
            warnings.push(format!(
                "mode \"{name}\": only {:.1} samples in a cycle; {COARSE} and more are advisable: shorten step",
                self.samples_per_cycle
            ));
        }
        if let Some(time) = self.below_curves_from {
            warnings.push(format!(
                "mode \"{name}\": from t = {} s on the amplitude is below the smallest of the curves; frequency and damping \
                 are held there",
                short(time)
            ));
        }
        if let Some(time) = self.above_curves_from {
            warnings.push(format!(
                "mode \"{name}\": from t = {} s on the amplitude exceeds the largest of the curves; extrapolate = true holds \
                 frequency and damping there",
                short(time)
            ));
        }
        if self.forgotten_force > 0.0 {
            warnings.push(format!(
                "mode \"{name}\": reversals were forgotten for lack of room; the joint force is off by at most {:.3e}",
                self.forgotten_force
            ));
        }
        warnings
    }
}

impl PointSummary {
    /// Makes the summary of a point from its displacement, velocity and acceleration.
    pub(crate) fn new(name: &str, [displacement, velocity, acceleration]: &[Vec<f64>; 3]) -> Self {
        Self::of_peaks(name, [peak(displacement), peak(velocity), peak(acceleration)])
    }

    /// Makes the summary of a point from the peaks of its displacement, velocity and acceleration.
    pub(crate) fn of_peaks(name: &str, [displacement, velocity, acceleration]: [f64; 3]) -> Self {
        Self {
            name: name.into(),
            peak_displacement: displacement,
            peak_velocity: velocity,
            peak_acceleration: acceleration,
        }
    }
}

/// A share in per cent: 0.0123 becomes "1.23 %".
fn percent(share: f64) -> String {
    format!("{:.2} %", 100.0 * share)
}

/// One line of the table.
pub(crate) struct Row {
    /// Label of the line.
    pub(crate) label: &'static str,
    /// Text of the line for one mode.
    pub(crate) cell: fn(&ModeSummary) -> String,
}

/// The lines of the table of modes, for the terminal and the page.
pub(crate) const ROWS: [Row; 12] = [
    Row { label: "frequency, Hz", cell: |m| short(m.frequency) },
    Row { label: "viscous damping ratio", cell: |m| short(m.damping_ratio) },
    Row { label: "phi_max", cell: |m| or_dash(m.phi_max, short) },
    Row { label: "peak displacement", cell: |m| short(m.peak_displacement) },
    Row { label: "final displacement", cell: |m| short(m.final_displacement) },
    Row { label: "slip ratio", cell: |m| short(m.slip_ratio) },
    Row { label: "energy error", cell: |m| error(m.energy_error) },
    Row { label: "time-step error", cell: |m| or_dash(m.time_step_error, error) },
    Row { label: "discretisation error", cell: |m| or_dash(m.discretisation_error, error) },
    Row { label: "samples in a cycle", cell: |m| format!("{:.0}", m.samples_per_cycle) },
    Row { label: "steps", cell: |m| m.steps.to_string() },
    Row { label: "seconds", cell: |m| format!("{:.2e}", m.seconds) },
];

/// Modes side by side in the table: 22 columns for the label and 12 for each mode stay within the 80 of a terminal as long as names have at most ten
/// letters; further modes follow in another block.
const ABREAST: usize = 4;

impl SimulationSummary {
    /// Makes the summary from the scenario (called `name` where it has no title), the responses of its modes, and the named points.
    pub(super) fn new(
        scenario: &Scenario,
        name: &str,
        response: &CoupledResponse,
        points: &[PointResponse],
        seconds: f64,
    ) -> Self {
        let totals: Vec<Totals> = response.modes.iter().map(Response::totals).collect();
        let coupled = (!scenario.joints.is_empty()).then(|| CoupledSummary::new(response));
        let points = points.iter().map(|(name, samples)| PointSummary::new(name, samples)).collect();
        Self::of(scenario, name, &totals, coupled, points, seconds)
    }

    /// Makes the same summary from the totals that are kept of streamed responses.
    pub(super) fn of(
        scenario: &Scenario,
        name: &str,
        totals: &[Totals],
        coupled: Option<CoupledSummary>,
        points: Vec<PointSummary>,
        seconds: f64,
    ) -> Self {
        let each = scenario.modes.iter().zip(totals);
        let modes: Vec<_> = each.map(|(m, totals)| ModeSummary::new(&m.mode, totals)).collect();
        let of_joints = coupled.iter().flat_map(CoupledSummary::warnings);
        Self {
            scenario: scenario.title.clone().unwrap_or_else(|| name.into()),
            method: match scenario.settings.method {
                Method::Newmark { .. } => "newmark",
                Method::HalfCycle => "half-cycle",
                Method::Averaging => "averaging",
                Method::Event { .. } => "event",
            },
            time_step: scenario.settings.dt,
            duration: scenario.settings.duration,
            warnings: modes.iter().flat_map(ModeSummary::warnings).chain(of_joints).collect(),
            modes,
            structure: None,
            coupled,
            points,
            seconds,
        }
    }
}

impl Summary for SimulationSummary {
    fn warnings(&self) -> &[String] {
        &self.warnings
    }

    fn text(&self) -> String {
        let blocks: Vec<_> = self.modes.chunks(ABREAST).map(block).collect();
        let mut text = blocks.join("\n");
        if !self.points.is_empty() {
            text.push_str("\npeaks                  displacement      velocity  acceleration\n");
        }
        for p in &self.points {
            let [q, v, a] = [p.peak_displacement, p.peak_velocity, p.peak_acceleration].map(short);
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{:<22} {q:>12}  {v:>12}  {a:>12}", p.name);
        }
        let of_structure = self.structure.iter().flat_map(|structure| &structure.slips);
        let of_joints = self.coupled.iter().flat_map(|coupled| &coupled.joints).map(|joint| &joint.slip);
        let slips = of_structure.chain(of_joints);
        for (n, slip) in slips.enumerate() {
            if n == 0 {
                text.push_str("\npeaks                          slip         force    slip ratio\n");
            }
            let [s, f, r] = [slip.peak_slip, slip.peak_force, slip.slip_ratio].map(short);
            let _ = writeln!(text, "{:<22} {s:>12}  {f:>12}  {r:>12}", slip.name);
        }
        text
    }
}

fn block(modes: &[ModeSummary]) -> String {
    let width = |m: &ModeSummary| m.name.chars().count().max(10);
    let line = |label: &str, cell: &dyn Fn(&ModeSummary) -> String| {
        let cells: Vec<_> =
            modes.iter().map(|m| format!("  {:>width$}", cell(m), width = width(m))).collect();
        format!("{label:<22}{}\n", cells.concat())
    };
    let head = line("mode", &|m| m.name.clone());
    ROWS.iter().fold(head, |text, row| text + &line(row.label, &row.cell))
}
