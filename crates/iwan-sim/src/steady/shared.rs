//! Modes that share joints, as a scenario or a program describes them, prepared for harmonic balance.

use std::f64::consts::TAU;

use iwan_core::Error;

use super::jointed::{JointedModes, Residual, SlipJoint, StuckMode};
use crate::coupled::{SharedJoint, assembled};
use crate::error::SimulationError;
use crate::mode::Mode;

/// Frequencies of a mode with all joints slipping and with all joints stuck, Hz.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StuckRange {
    /// Frequency with all joints slipping, from the stiffness under static loads, Hz.
    pub slipping: f64,
    /// Frequency at small amplitude, with all joints stuck, Hz.
    pub stuck: f64,
}

impl JointedModes {
    /// The system of modes that share joints, with the equations of `iwan_core::CoupledModes`; a mode's own joint counts as a joint that no
    /// other mode shares. `at_output` has the response per unit of displacement of each mode.
    ///
    /// ```
    /// use iwan_core::FourParameter;
    /// use iwan_sim::{JointLaw, JointedModes, Mode, SharedJoint, nonlinear_mode};
    /// let law = JointLaw::FourParameter(FourParameter::new(3.16e4, 143.8, -0.3, 0.02)?);
    /// let modes = [Mode::new("bending 1", 132.35, None), Mode::new("bending 3", 719.6, None)];
    /// let joint = SharedJoint { compliance: vec![9.1e-6], ..SharedJoint::new("link", law, vec![1.0, -4.905], 1) };
    /// let system = JointedModes::of_coupled(&modes, &[joint], &[1.0, 1.0])?;
    /// let curve = nonlinear_mode(&system, 0, 3, &[1e-5, 1e-3])?;
    /// assert!(curve.points[1].frequency < curve.points[0].frequency);
    /// # Ok::<(), iwan_sim::SimulationError>(())
    /// ```
    ///
    /// # Errors
    /// [`SimulationError::Joint`] and [`SimulationError::Mode`] with the name of the joint or mode whose value is out of range or does not
    /// fit (a mode with parts or curves does not, because the modes are linear beside the joints); [`SimulationError::Parameter`] for
    /// joints that no stiffness holds.
    pub fn of_coupled(
        modes: &[Mode],
        shared: &[SharedJoint],
        at_output: &[f64],
    ) -> Result<Self, SimulationError> {
        if at_output.len() != modes.len() {
            let (needed, found) = (modes.len(), at_output.len());
            return Err(Error::Length { name: "at_output", needed, found }.into());
        }
        let (joints, _) = assembled(modes, shared)?;
        let stuck = modes.iter().zip(at_output).map(|(mode, &at_output)| StuckMode {
            omega: TAU * mode.frequency,
            damping_ratio: mode.damping_ratio,
            at_force: mode.shape_at_force,
            at_output,
        });
        let residual = Residual {
            slips: joints.iter().flat_map(|joint| joint.compliance.iter().copied()).collect(),
            force: joints.iter().map(|joint| joint.slip_at_force).collect(),
            ..Residual::default()
        };
        let slip = |joint: SharedJoint| SlipJoint {
            name: joint.name,
            law: joint.law.into(),
            participation: joint.participation,
        };
        Self::new(stuck.collect(), joints.into_iter().map(slip).collect(), residual)
    }

    /// The same system under an acceleration of the base, where each `at_force` is a mode's participation φᵀM1. The responses are relative
    /// to the base, so the signs of the excitation are reversed.
    #[must_use]
    pub fn on_moving_base(mut self) -> Self {
        for mode in &mut self.modes {
            mode.at_force *= -1.0;
        }
        for slip in &mut self.residual.force {
            *slip *= -1.0;
        }
        self.residual.direct *= -1.0;
        self
    }
}

impl StuckRange {
    /// The range of each mode, by itself, under static loads.
    ///
    /// # Errors
    /// The errors of [`JointedModes::of_coupled`].
    pub fn of_coupled(modes: &[Mode], shared: &[SharedJoint]) -> Result<Vec<Self>, SimulationError> {
        let (_, lost) = assembled(modes, shared)?;
        let range = |(mode, k_t): (&Mode, &f64)| {
            let left = (TAU * mode.frequency).powi(2) - k_t;
            Self { slipping: left.max(0.0).sqrt() / TAU, stuck: mode.frequency }
        };
        Ok(modes.iter().zip(&lost).map(range).collect())
    }
}
