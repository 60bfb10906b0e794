//! Modes that several joints couple: what the harmonic balance of a structure, or of one mode with harmonics, works on.

use iwan_core::{Backbone, Error};

use crate::error::SimulationError;
use crate::joint_law::JointLaw;
use crate::mode::Mode;

/// A mode of the structure with all joints stuck (each with its initial stiffness K_T), mass-normalised.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StuckMode {
    /// Circular frequency, rad/s.
    pub omega: f64,
    /// Viscous damping ratio.
    pub damping_ratio: f64,
    /// Modal force of a unit excitation (a force, or an acceleration of the base).
    pub at_force: f64,
    /// Response of a unit modal displacement.
    pub at_output: f64,
}

/// A joint between the modes.
#[derive(Debug, Clone, PartialEq)]
pub struct SlipJoint {
    /// Its name, for messages.
    pub name: String,
    /// Its law.
    pub law: JointLaw,
    /// Its slip in unit modal displacement of each mode.
    pub participation: Vec<f64>,
}

/// What the modes that were left out do: static flexibilities.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Residual {
    /// Slip of joint i from unit force pairs on joint j at `i * joints + j`; empty for none.
    pub slips: Vec<f64>,
    /// Slip of each joint from a unit excitation; empty for none.
    pub force: Vec<f64>,
    /// Response from unit force pairs on each joint; empty for none.
    pub output: Vec<f64>,
    /// Response from a unit excitation.
    pub direct: f64,
}

/// Stuck modes and the joints that couple them.
#[derive(Debug, Clone, PartialEq)]
pub struct JointedModes {
    pub(super) modes: Vec<StuckMode>,
    pub(super) joints: Vec<SlipJoint>,
    pub(super) residual: Residual,
}

impl JointedModes {
    /// Checks and takes modes, joints and residual flexibilities.
    ///
    /// # Errors
    /// [`SimulationError::Parameter`] for what does not fit or is not finite, and for modes at zero frequency: a free
    /// structure has no steady motion about a mean place, so its zero modes are to be left out.
    pub fn new(
        modes: Vec<StuckMode>,
        joints: Vec<SlipJoint>,
        residual: Residual,
    ) -> Result<Self, SimulationError> {
        let refuse = |name, value, allowed| Err(Error::OutOfRange { name, value, allowed }.into());
        if modes.is_empty() {
            return Err(Error::Length { name: "modes", needed: 1, found: 0 }.into());
        }
        for mode in &modes {
            if !(mode.omega > 0.0 && mode.omega.is_finite()) {
                let allowed = "must be > 0 (rad/s): leave the zero modes of a free structure out";
                return refuse("omega", mode.omega, allowed);
            }
            if !(0.0..1.0).contains(&mode.damping_ratio) {
                return refuse("damping_ratio", mode.damping_ratio, "must satisfy 0 <= damping_ratio < 1");
            }
            for (name, value) in [("at_force", mode.at_force), ("at_output", mode.at_output)] {
                if !value.is_finite() {
                    return refuse(name, value, "must be a finite number");
                }
            }
        }
        let lengths = [
            ("residual slips", residual.slips.len(), joints.len() * joints.len()),
            ("residual force", residual.force.len(), joints.len()),
            ("residual output", residual.output.len(), joints.len()),
        ];
        for (name, found, needed) in lengths {
            if found != 0 && found != needed {
                return Err(Error::Length { name, needed, found }.into());
            }
        }
        for joint in &joints {
            let found = joint.participation.len();
            if found != modes.len() {
                return Err(Error::Length { name: "participation", needed: modes.len(), found }.into());
            }
            if let Some(&value) = joint.participation.iter().find(|b| !b.is_finite()) {
                return refuse("participation", value, "must be a finite number");
            }
        }
        let all = residual.slips.iter().chain(&residual.force).chain(&residual.output);
        if let Some(&value) = all.chain([&residual.direct]).find(|r| !r.is_finite()) {
            return refuse("residual flexibility", value, "must be a finite number");
        }
        Ok(Self { modes, joints, residual })
    }

    /// One mode with its own joint, in modal coordinates; its response is `shape_at_output` times the modal displacement.
    ///
    /// # Errors
    /// As [`Mode::oscillator`], and for a mode without a joint.
    pub fn of_mode(mode: &Mode, shape_at_output: f64) -> Result<Self, SimulationError> {
        let oscillator = mode.oscillator()?;
        let Some(law) = mode.joint.clone() else {
            return Err(
                Error::Unsupported { what: "a mode without a joint is linear and has no harmonics" }.into()
            );
        };
        let stuck = StuckMode {
            omega: oscillator.omega0(),
            damping_ratio: oscillator.damping_ratio(),
            at_force: mode.shape_at_force,
            at_output: shape_at_output,
        };
        let joint = SlipJoint { name: mode.name.clone(), law, participation: vec![1.0] };
        Self::new(vec![stuck], vec![joint], Residual::default())
    }

    /// The modes.
    #[must_use]
    pub fn modes(&self) -> &[StuckMode] {
        &self.modes
    }

    /// The joints.
    #[must_use]
    pub fn joints(&self) -> &[SlipJoint] {
        &self.joints
    }

    /// Slip at which the first joint is in macro-slip in the shape of a mode, as modal displacement; none where no joint slips in
    /// it.
    #[must_use]
    pub fn macro_slip(&self, mode: usize) -> Option<f64> {
        let reach = |joint: &SlipJoint| joint.law.strengths().1 / joint.participation[mode].abs();
        self.joints.iter().map(reach).filter(|q| q.is_finite()).min_by(f64::total_cmp)
    }
}
