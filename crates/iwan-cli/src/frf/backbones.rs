//! The nonlinear modes that the responses of coupled modes follow.

use std::f64::consts::TAU;

use iwan_sim::{JointedModes, SimulationError, SteadyCurve, Sweep, nonlinear_mode};

use super::responses::{POINTS, backbone_range};

/// Frequency and amplitude of every mode that shows in the band, within the amplitudes of the curves.
pub(super) fn backbones(
    system: &JointedModes,
    sweep: &Sweep,
    curves: &[SteadyCurve],
) -> Result<Vec<Vec<(f64, f64)>>, SimulationError> {
    resonant(system, sweep).into_iter().map(|mode| backbone(system, mode, sweep.harmonics, curves)).collect()
}

/// The modes with a frequency in the band that force and response reach.
fn resonant(system: &JointedModes, sweep: &Sweep) -> Vec<usize> {
    /// Residues smaller than this part of the largest in the band do not show: symmetry forbids such modes.
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

/// Frequency and amplitude at the point of a nonlinear mode, within the amplitudes of the curves.
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
