//! Modes coupled by joints: the system on which the harmonic balance of a structure, or of one mode with harmonics, works.

use std::fmt;
use std::sync::Arc;

use iwan_core::{Backbone, Error, TabledFourParameter};

use crate::error::SimulationError;
use crate::joint_law::JointLaw;
use crate::mode::Mode;

/// A mode of the structure with all joints stuck (each with its initial stiffness K_T), mass-normalised.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StuckMode {
    /// Circular frequency, rad/s; 0 for a rigid motion, in which no joint slips.
    pub omega: f64,
    /// Viscous damping ratio.
    pub damping_ratio: f64,
    /// Modal force per unit of the excitation (a force, or an acceleration of the base).
    pub at_force: f64,
    /// Response per unit of modal displacement.
    pub at_output: f64,
}

/// A joint law that any number of joints and threads share.
pub type SharedLaw = Arc<dyn Backbone + Send + Sync>;

/// A joint that couples modes.
#[derive(Clone)]
pub struct SlipJoint {
    /// Its name, for messages.
    pub name: String,
    /// Its law.
    pub law: SharedLaw,
    /// Slip of the joint in a unit displacement of each mode.
    pub participation: Vec<f64>,
}

impl fmt::Debug for SlipJoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let law = (self.law.initial_stiffness(), self.law.slip_force());
        f.debug_struct("SlipJoint").field("name", &self.name).field("k_t, f_s", &law).finish_non_exhaustive()
    }
}

impl From<JointLaw> for SharedLaw {
    /// A four-parameter law gets a table for its power, because a steady loop needs some hundred powers.
    fn from(law: JointLaw) -> Self {
        match law {
            JointLaw::FourParameter(law) => Arc::new(TabledFourParameter::new(law)),
            other => Arc::new(other),
        }
    }
}

/// Static flexibilities of the modes that are left out.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Residual {
    /// Slip of joint i under a unit pair of forces on joint j, at `i * joints + j`; empty for none.
    pub slips: Vec<f64>,
    /// Slip of each joint under a unit excitation; empty for none.
    pub force: Vec<f64>,
    /// Response to a unit pair of forces on each joint; empty for none.
    pub output: Vec<f64>,
    /// Response to a unit excitation.
    pub direct: f64,
}

/// Stuck modes and the joints that couple them.
#[derive(Debug, Clone)]
pub struct JointedModes {
    pub(super) modes: Vec<StuckMode>,
    pub(super) joints: Vec<SlipJoint>,
    pub(super) residual: Residual,
}

impl JointedModes {
    /// Checks and takes modes, joints and residual flexibilities.
    ///
    /// # Errors
    /// [`SimulationError::Parameter`] for rows that do not fit or are not finite, for a system without an elastic mode, for a joint whose
    /// friction drops, and for a joint that slips in a rigid motion, because nothing would return it to its place.
    pub fn new(
        modes: Vec<StuckMode>,
        joints: Vec<SlipJoint>,
        residual: Residual,
    ) -> Result<Self, SimulationError> {
        modes.iter().try_for_each(StuckMode::checked)?;
        if modes.iter().all(|mode| mode.omega == 0.0) {
            let allowed = "at least one mode must have a frequency > 0";
            return Err(Error::OutOfRange { name: "omega", value: 0.0, allowed }.into());
        }
        joints.iter().try_for_each(|joint| joint.checked(&modes))?;
        if joints.iter().any(|joint| joint.law.friction_ratio() != 1.0) {
            let what = "harmonics of a joint rest on Masing's rule, which one with theta < 1 (dynamic below static friction) does not \
                follow: take harmonics = 1";
            return Err(Error::Unsupported { what }.into());
        }
        residual.checked(joints.len())?;
        Ok(Self { modes, joints, residual })
    }

    /// One mode with its own joint, in modal coordinates; its response is `shape_at_output` times the modal displacement.
    ///
    /// # Errors
    /// The errors of [`Mode::oscillator`]; also [`SimulationError::Parameter`] for a mode without a joint.
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
        let joint = SlipJoint { name: mode.name.clone(), law: law.into(), participation: vec![1.0] };
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

    /// Circular frequency of the lowest elastic mode, rad/s; the unit of frequencies.
    pub(super) fn lowest(&self) -> f64 {
        self.modes.iter().map(|mode| mode.omega).filter(|omega| *omega > 0.0).fold(f64::INFINITY, f64::min)
    }

    /// Whether joints slip in a mode by more than rounding. In many modes symmetry prevents slip.
    pub(super) fn slips_in(&self, mode: usize) -> bool {
        /// Smallest slip, relative to the largest of any mode, that is not rounding. On the paper's beam rounding is below 1e-11, and the
        /// smallest true slip is 1e-5.
        const ROUNDING: f64 = 1e-8;
        let most = |joint: &SlipJoint| joint.participation.iter().fold(0.0, |most: f64, b| most.max(b.abs()));
        self.joints.iter().any(|joint| joint.participation[mode].abs() > ROUNDING * most(joint))
    }

    /// Modal displacement at which the first joint reaches macro-slip in the shape of a mode; none if no joint slips in the mode.
    #[must_use]
    pub fn macro_slip(&self, mode: usize) -> Option<f64> {
        if !self.slips_in(mode) {
            return None;
        }
        let reach = |joint: &SlipJoint| joint.law.strengths().1 / joint.participation[mode].abs();
        self.joints.iter().map(reach).filter(|q| q.is_finite()).min_by(f64::total_cmp)
    }
}

impl StuckMode {
    fn checked(&self) -> Result<(), SimulationError> {
        let refuse = |name, value, allowed| Err(Error::OutOfRange { name, value, allowed }.into());
        if !(self.omega >= 0.0 && self.omega.is_finite()) {
            return refuse("omega", self.omega, "must be a finite number of rad/s >= 0");
        }
        if !(0.0..1.0).contains(&self.damping_ratio) {
            return refuse("damping_ratio", self.damping_ratio, "must satisfy 0 <= damping_ratio < 1");
        }
        let shapes = [("at_force", self.at_force), ("at_output", self.at_output)];
        match shapes.iter().find(|(_, value)| !value.is_finite()) {
            Some(&(name, value)) => refuse(name, value, "must be a finite number"),
            None => Ok(()),
        }
    }
}

impl SlipJoint {
    fn checked(&self, modes: &[StuckMode]) -> Result<(), SimulationError> {
        /// Largest slip in a rigid motion, relative to the largest in any mode, that counts as rounding; a larger one is refused.
        const RIGID: f64 = 1e-6;
        let found = self.participation.len();
        if found != modes.len() {
            return Err(Error::Length { name: "participation", needed: modes.len(), found }.into());
        }
        let refuse = |value, allowed| Err(Error::OutOfRange { name: "participation", value, allowed }.into());
        if let Some(&value) = self.participation.iter().find(|b| !b.is_finite()) {
            return refuse(value, "must be a finite number");
        }
        let most = self.participation.iter().fold(0.0, |most: f64, b| most.max(b.abs()));
        let rigid = self.participation.iter().zip(modes).filter(|(_, mode)| mode.omega == 0.0);
        match rigid.map(|(b, _)| *b).find(|b| b.abs() > RIGID * most) {
            Some(value) => refuse(value, "must be 0 in a rigid motion (a mode of frequency 0)"),
            None => Ok(()),
        }
    }
}

impl Residual {
    fn checked(&self, joints: usize) -> Result<(), SimulationError> {
        let lengths = [
            ("residual slips", self.slips.len(), joints * joints),
            ("residual force", self.force.len(), joints),
            ("residual output", self.output.len(), joints),
        ];
        if let Some(&(name, found, needed)) =
            lengths.iter().find(|(_, found, needed)| *found != 0 && found != needed)
        {
            return Err(Error::Length { name, needed, found }.into());
        }
        let all = self.slips.iter().chain(&self.force).chain(&self.output).chain([&self.direct]);
        match all.copied().find(|r| !r.is_finite()) {
            Some(value) => {
                let allowed = "must be a finite number";
                Err(Error::OutOfRange { name: "residual flexibility", value, allowed }.into())
            }
            None => Ok(()),
        }
    }
}
