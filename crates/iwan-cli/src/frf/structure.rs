//! The forced response of a structure at one of its points.

use std::f64::consts::TAU;

use iwan_input::scenario::{OnStructure, SweepTable};
use iwan_sim::{Control, SteadyCurve, forced_response_of, nonlinear_mode};

use super::responses::{POINTS, Response, backbone_range, by_level};
use crate::failure::Failure;
use crate::session::Session;
use crate::structures::{Linear, Steady};

/// The response of the structure, and what the reader should know.
pub(super) fn respond(
    on: &OnStructure,
    table: &SweepTable,
    session: &Session,
) -> Result<(Vec<Response>, Vec<String>), Failure> {
    if table.sweep.control == Control::BaseAcceleration {
        let message =
            "[sweep]: base_acceleration is for modes: a structure is driven by the forces of its [[load]]";
        return Err(Failure::input(message, "give force, or a response that is held"));
    }
    let (source, file) = on.load()?;
    let mut notes = file.notes.clone();
    let bar = session.bar("modes");
    let linear = Linear::computed(source, file, iwan_fem::NamedModes::LOOKED_UP, &bar)?;
    drop(bar);
    let steady = Steady::new(&linear, on.model, table.at.as_deref(), table.damping_ratio.unwrap_or(0.0))?;
    let busy = session.busy("balancing harmonics");
    let failed =
        |error: &iwan_sim::SimulationError| Failure::Computation(format!("{}: {error}", linear.source));
    let curves = by_level(&table.sweep, session.threads(), &|sweep| forced_response_of(&steady.modes, sweep))
        .map_err(|error| failed(&error))?;
    let mut backbones = Vec::new();
    for mode in resonant(&steady, table) {
        let found =
            backbone(&steady, mode, table.sweep.harmonics, &curves).map_err(|error| failed(&error))?;
        backbones.push(found);
    }
    drop(busy);
    if backbones.is_empty() {
        notes.push(format!(
            "no mode has its resonance between {} and {} Hz",
            table.sweep.from, table.sweep.to
        ));
    }
    notes.push(format!("response: {}", steady.output));
    let name = linear.file.title.clone().unwrap_or_else(|| linear.source.clone());
    Ok((vec![Response { name, frequency: None, joint: None, curves, backbones }], notes))
}

/// The modes with a frequency in the band that force and response reach.
fn resonant(steady: &Steady, table: &SweepTable) -> Vec<usize> {
    /// Residues smaller than this part of the largest in the band do not show: symmetry forbids such modes.
    const SHOWN: f64 = 1e-6;
    let modes = steady.modes.modes();
    let band = TAU * table.sweep.from..=TAU * table.sweep.to;
    let residue = |mode: usize| (modes[mode].at_force * modes[mode].at_output).abs();
    let within: Vec<usize> = (0..modes.len()).filter(|&mode| band.contains(&modes[mode].omega)).collect();
    let most = within.iter().map(|&mode| residue(mode)).fold(0.0, f64::max);
    within
        .into_iter()
        .filter(|&mode| residue(mode) > SHOWN * most && steady.modes.macro_slip(mode).is_some())
        .collect()
}

/// Frequency and amplitude at the point of a nonlinear mode, within the amplitudes of the curves.
fn backbone(
    steady: &Steady,
    mode: usize,
    harmonics: usize,
    curves: &[SteadyCurve],
) -> Result<Vec<(f64, f64)>, iwan_sim::SimulationError> {
    let Some([low, high]) = backbone_range(curves) else { return Ok(Vec::new()) };
    let shape = steady.modes.modes()[mode].at_output.abs();
    let amplitude = |i: usize| low / shape * (high / low).powf(i as f64 / (POINTS - 1) as f64);
    let amplitudes: Vec<f64> = (0..POINTS).map(amplitude).collect();
    let branch = nonlinear_mode(&steady.modes, mode, harmonics, &amplitudes)?;
    Ok(branch.points.iter().map(|point| (point.frequency, point.response[0])).collect())
}
