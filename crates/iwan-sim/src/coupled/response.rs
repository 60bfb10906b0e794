//! What a simulation of coupled modes returns.

use iwan_core::EnergyBalance;

use crate::response::{Quality, Response};

/// One joint in the course of a response.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct JointHistory {
    /// Name of the joint.
    pub name: String,
    /// Slip s.
    pub slip: Vec<f64>,
    /// Force F.
    pub force: Vec<f64>,
    /// Strength φ_max of its strongest slider.
    pub strongest: f64,
    /// Energy that its sliders took.
    pub friction: f64,
    /// Bound on the error of its force from reversals forgotten for lack of room; 0 = exact.
    pub forgotten_force: f64,
}

impl JointHistory {
    /// Largest |s|.
    #[must_use]
    pub fn peak_slip(&self) -> f64 {
        self.slip.iter().fold(0.0, |peak, s| peak.max(s.abs()))
    }

    /// Largest |F|.
    #[must_use]
    pub fn peak_force(&self) -> f64 {
        self.force.iter().fold(0.0, |peak, f| peak.max(f.abs()))
    }

    /// Largest |s| in units of φ_max: macro-slip above 1.
    #[must_use]
    pub fn slip_ratio(&self) -> f64 {
        self.peak_slip() / self.strongest
    }
}

/// Response of modes that joints couple.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CoupledResponse {
    /// One entry per mode. Of a mode that shares joints, `joint_force` is K_T q + Σ b N, what the joints add to the
    /// slipping structure; `energy` is its own balance, whose friction is the work it did on the joints; `strongest` is
    /// the displacement at which it would bring a joint to macro-slip by itself.
    pub modes: Vec<Response>,
    /// The shared joints, then the own joints of the modes they couple.
    pub joints: Vec<JointHistory>,
    /// Energy balance of all coupled modes and joints.
    pub energy: EnergyBalance,
    /// Error estimates: the worst of the coupled modes.
    pub quality: Quality,
    /// Wall-clock time of the integration of the coupled modes, s.
    pub seconds: f64,
}
