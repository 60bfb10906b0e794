//! The backbones of nonlinear modes, drawn over the responses of coupled modes.

use std::f64::consts::TAU;

use iwan_sim::{JointedModes, SimulationError, SteadyCurve, Sweep, nonlinear_mode};

use super::responses::{POINTS, backbone_range};

/// Backbone (frequency in Hz, amplitude) of every mode that shows in the band, over the amplitudes of the curves.
pub(super) fn backbones(
    system: &JointedModes,
    sweep: &Sweep,
    curves: &[SteadyCurve],
) -> Result<Vec<Vec<(f64, f64)>>, SimulationError> {
    resonant(system, sweep).into_iter().map(|mode| backbone(system, mode, sweep.harmonics, curves)).collect()
}

/// The modes with a frequency in the band that the force excites and the response point sees.
fn resonant(system: &JointedModes, sweep: &Sweep) -> Vec<usize> {
    /// A mode whose residue (shape at the force times shape at the output) is below this part of the largest in the band gets no backbone: symmetry
    /// forbids its response, and what is left is rounding.
    const SHOWN: f64 = 1e-6;
    let modes = system.modes();
    let band = TAU * sweep.from..=TAU * sweep.to;
    let residue = |mode: usize| (modes[mode].at_force * modes[mode].at_output).abs();
    let within: Vec<usize> = (0..modes.len()).filter(|&mode| band.contains(&modes[mode].omega)).collect();
    let most = within.iter().map(|&mode| residue(mode)).fold(0.0, f64::max);
    within
        .into_iter()
        .filter(|&mode| residue(mode) > SHOWN * most && system.macro_slip(mode).is_some())
        .collect()
}

/// Backbone (frequency in Hz, amplitude at the output) of one nonlinear mode, over the amplitudes of the curves.
fn backbone(
    system: &JointedModes,
    mode: usize,
    harmonics: usize,
    curves: &[SteadyCurve],
) -> Result<Vec<(f64, f64)>, SimulationError> {
    let Some([low, high]) = backbone_range(curves) else { return Ok(Vec::new()) };
    let shape = system.modes()[mode].at_output.abs();
    let amplitude = |i: usize| low / shape * (high / low).powf(i as f64 / (POINTS - 1) as f64);
    let amplitudes: Vec<f64> = (0..POINTS).map(amplitude).collect();
    let branch = nonlinear_mode(system, mode, harmonics, &amplitudes)?;
    Ok(branch.points.iter().map(|point| (point.frequency, point.response[0])).collect())
}
