//! The summary of a run on a structure.

use iwan_fem::{History, SlipHistory};
use iwan_input::scenario::Scenario;

use super::run::Truth;
use crate::simulate::summary::{
    Energy, ModeSummary, PointSummary, SimulationSummary, SlipSummary, StructureSummary, peak,
};
use crate::structures::Size;

/// Makes the summary of a scenario, which is called `name` where it has no title.
pub(super) fn summarise(scenario: &Scenario, name: &str, truth: &Truth) -> SimulationSummary {
    let modes: Vec<ModeSummary> = (0..truth.modes.len()).map(|n| mode_summary(truth, n)).collect();
    let points = &truth.response.outputs[truth.modes.len()..];
    let point = |p: &History| {
        PointSummary::of_peaks(&p.name, [&p.displacement, &p.velocity, &p.acceleration].map(|v| peak(v)))
    };
    let structure = structure_summary(truth);
    let warnings = modes.iter().flat_map(ModeSummary::warnings).chain(structure.warnings()).collect();
    SimulationSummary {
        scenario: scenario.title.clone().unwrap_or_else(|| name.into()),
        method: "newmark",
        time_step: scenario.settings.dt,
        duration: scenario.settings.duration,
        warnings,
        modes,
        points: points.iter().map(point).collect(),
        structure: Some(structure),
        coupled: None,
        seconds: truth.seconds,
    }
}

/// The summary of mode `n`. Its slip ratio is that of the joint that slips most, and its energies are those of the whole structure.
fn mode_summary(truth: &Truth, n: usize) -> ModeSummary {
    let (mode, response) = (&truth.modes[n], &truth.response);
    let history = &response.outputs[n];
    let frequency = truth.linear.frequency_stuck(mode);
    ModeSummary {
        name: mode.name.clone(),
        frequency,
        damping_ratio: 0.0,
        phi_max: None,
        peak_displacement: peak(&history.displacement),
        peak_acceleration: peak(&history.acceleration),
        final_displacement: history.displacement.last().copied().unwrap_or(0.0),
        slip_ratio: response.slips.iter().fold(0.0, |most: f64, slip| most.max(slip.slip_ratio)),
        energy_error: response.energy.error(),
        time_step_error: truth.errors.as_ref().map(|errors| errors.time_step[n]),
        discretisation_error: truth.errors.as_ref().and_then(|errors| Some(errors.sliders.as_ref()?[n])),
        forgotten_force: response.forgotten_force,
        below_curves_from: None,
        above_curves_from: None,
        samples_per_cycle: 1.0 / (frequency * response.dt),
        steps: history.displacement.len() - 1,
        seconds: response.seconds,
        energy: Energy::from(&response.energy),
    }
}

fn structure_summary(truth: &Truth) -> StructureSummary {
    let slip = |slip: &SlipHistory| SlipSummary {
        name: slip.name.clone(),
        peak_slip: peak(&slip.slip),
        peak_force: peak(&slip.force),
        slip_ratio: slip.slip_ratio,
    };
    StructureSummary {
        title: truth.linear.file.title.clone().unwrap_or_else(|| truth.linear.source.clone()),
        size: Size::of(&truth.linear),
        model: if truth.basis.is_some() { "reduced" } else { "full" },
        basis: truth.basis,
        basis_error: truth.basis_error.map(|error| error.estimate),
        converged: truth.basis_error.map(|error| error.converged),
        slips: truth.response.slips.iter().map(slip).collect(),
    }
}
