//! A run of the modes that share joints, with all joints that they move.

use iwan_core::{
    Backbone, CoupledJoint, CoupledMode, CoupledModes, Error, Lanes, Newmark, Oscillator, ResidualStiffness,
};

use super::joint::{SharedJoint, Statics, check_rows, of_joint};
use crate::error::SimulationError;
use crate::mode::Mode;

/// Message with which a joint whose friction drops is refused.
const DROPS: &str = "joints of coupled modes follow Masing's rule, and one with theta < 1 (dynamic below static friction) does not: \
    leave theta out, or step its mode alone";

/// Memory for the core: the requested number of groups.
pub(super) fn storage(groups: usize) -> Vec<Lanes> {
    vec![[0.0; 4]; groups]
}

/// A run of coupled modes: force samples (physical, from t = 0, zero after the last) and time axis.
pub(super) struct Task<'a> {
    pub(super) modes: Vec<&'a Mode>,
    /// Shared joints, followed by the own joints of the modes; participations refer to `modes` only.
    pub(super) joints: Vec<SharedJoint>,
    pub(super) force: &'a [f64],
    pub(super) dt: f64,
    pub(super) samples: usize,
    /// K_T of each mode.
    pub(super) modal_stiffness: Vec<f64>,
}

/// Indices of the modes that share joints, and of those that do not.
pub(super) fn parted(modes: &[Mode], joints: &[SharedJoint]) -> [Vec<usize>; 2] {
    let shares = |r: &usize| joints.iter().any(|joint| joint.moved_by(*r));
    let (coupled, alone) = (0..modes.len()).partition(shares);
    [coupled, alone]
}

/// A row of numbers by joint, with zeros appended for the joints that follow.
fn widened(row: &[f64], joints: usize) -> Vec<f64> {
    row.iter().copied().chain(std::iter::repeat(0.0)).take(joints).collect()
}

/// All shared joints and own joints of the modes as they stand in the equations, with K_T of each mode. The rows are checked, and so is
/// that the structure still holds when all joints slip.
///
/// # Errors
/// The errors of [`simulate_coupled`](super::simulate_coupled) that do not depend on the time step.
pub(crate) fn assembled(
    modes: &[Mode],
    shared: &[SharedJoint],
) -> Result<(Vec<SharedJoint>, Vec<f64>), SimulationError> {
    let all: Vec<usize> = (0..modes.len()).collect();
    let task = Task::new(modes, &all, shared, (&[], 1.0, 0))?;
    Statics::new(&task.modes, &task.joints).check(&task.modes)?;
    Ok((task.joints, task.modal_stiffness))
}

impl<'a> Task<'a> {
    /// The run of the modes with the indices `chosen`, with their joints.
    pub(super) fn new(
        all: &'a [Mode],
        chosen: &[usize],
        shared: &[SharedJoint],
        (force, dt, samples): (&'a [f64], f64, usize),
    ) -> Result<Self, SimulationError> {
        check_rows(all, shared)?;
        let modes: Vec<&Mode> = chosen.iter().map(|r| &all[*r]).collect();
        for mode in &modes {
            mode.oscillator().map_err(|error| of_mode(mode, error))?;
            if !mode.is_plain() {
                let what = "a mode that moves a shared joint is linear beside its own joint: leave out parts and curves";
                return Err(of_mode(mode, Error::Unsupported { what }));
            }
            if mode.friction_drops() {
                return Err(of_mode(mode, Error::Unsupported { what: DROPS }));
            }
        }
        if let Some(joint) = shared.iter().find(|joint| joint.law.friction_ratio() != 1.0) {
            return Err(of_joint(&joint.name, Error::Unsupported { what: DROPS }));
        }
        let own: Vec<(usize, &Mode)> =
            modes.iter().enumerate().filter(|(_, mode)| mode.joint.is_some()).map(|(r, m)| (r, *m)).collect();
        let count = shared.len() + own.len();
        let mut joints: Vec<SharedJoint> = shared
            .iter()
            .map(|joint| SharedJoint {
                participation: chosen.iter().map(|r| joint.participation[*r]).collect(),
                compliance: widened(&joint.compliance, count),
                ..joint.clone()
            })
            .collect();
        for (r, mode) in own {
            let Some(law) = mode.joint.clone() else { continue };
            let participation = (0..modes.len()).map(|i| if i == r { 1.0 } else { 0.0 }).collect();
            joints.push(SharedJoint::new(mode.name.clone(), law, participation, count));
        }
        let modal_stiffness = Statics::new(&modes, &joints).modal_stiffness();
        Ok(Self { modes, joints, force, dt, samples, modal_stiffness })
    }

    /// Refuses joints for which a step has no unique solution, then joints that no stiffness holds once they slip.
    pub(super) fn check(&self, prewarp: bool) -> Result<(), SimulationError> {
        self.coupled(prewarp)?;
        Ok(Statics::new(&self.modes, &self.joints).check(&self.modes)?)
    }

    /// The same modes and joints under another force, with another time axis.
    pub(super) fn beside<'b>(&'b self, (force, dt, samples): (&'b [f64], f64, usize)) -> Task<'b> {
        Task {
            modes: self.modes.clone(),
            joints: self.joints.clone(),
            force,
            dt,
            samples,
            modal_stiffness: self.modal_stiffness.clone(),
        }
    }

    /// Constants of the time steps, with each mode prewarped or not.
    pub(super) fn coupled(&self, prewarp: bool) -> Result<CoupledModes<Vec<Lanes>>, SimulationError> {
        let mode = |mode: &&Mode| -> Result<CoupledMode, SimulationError> {
            let constants = || -> Result<CoupledMode, Error> {
                let (f, zeta) = (mode.frequency, mode.damping_ratio);
                let oscillator = Oscillator::new(f, zeta, 0.0, ResidualStiffness::Positive)?;
                let scheme = if prewarp {
                    Newmark::prewarped(self.dt, oscillator.omega0())
                } else {
                    Newmark::average_acceleration(self.dt)
                };
                Ok(CoupledMode { oscillator, scheme: scheme?, shape_at_force: mode.shape_at_force })
            };
            constants().map_err(|error| of_mode(mode, error))
        };
        let modes = self.modes.iter().map(mode).collect::<Result<Vec<_>, _>>()?;
        // Each joint is checked by itself first, so that the error for a number out of range names the joint.
        for (i, joint) in self.joints.iter().enumerate() {
            let own = CoupledJoint { compliance: &joint.compliance[i..=i], ..of_row(joint) };
            CoupledModes::new(&modes, &[own], storage).map_err(|error| of_joint(&joint.name, error))?;
        }
        let rows: Vec<_> = self.joints.iter().map(of_row).collect();
        Ok(CoupledModes::new(&modes, &rows, storage)?)
    }
}

fn of_row(joint: &SharedJoint) -> CoupledJoint<'_> {
    CoupledJoint {
        stiffness: joint.law.initial_stiffness(),
        participation: &joint.participation,
        compliance: &joint.compliance,
        slip_at_force: joint.slip_at_force,
    }
}

pub(super) fn of_mode(mode: &Mode, error: impl Into<SimulationError>) -> SimulationError {
    SimulationError::Mode { mode: mode.name.clone(), source: Box::new(error.into()) }
}
