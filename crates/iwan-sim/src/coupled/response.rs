//! The result of a simulation of coupled modes.

use iwan_core::EnergyBalance;

use crate::response::{Quality, Response};

/// Slip and force of one joint over a response.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct JointHistory {
    /// Name of the joint.
    pub name: String,
    /// Slip s.
    pub slip: Vec<f64>,
    /// Force F.
    pub force: Vec<f64>,
    /// Strength φ_max of the joint's strongest slider.
    pub strongest: f64,
    /// Energy dissipated by the joint's sliders.
    pub friction: f64,
    /// Bound on the error of the joint's force from reversals forgotten because memory was full; 0 means exact.
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
    /// One entry per mode. For a mode that shares joints, `joint_force` is K_T q + Σ b N, the force that the joints add to the slipping
    /// structure. Its `energy` is the mode's own balance, in which friction is the work that the mode did on the joints. Its `strongest` is
    /// the displacement at which the mode alone would bring a joint to macro-slip.
    pub modes: Vec<Response>,
    /// The shared joints, followed by the own joints of the coupled modes.
    pub joints: Vec<JointHistory>,
    /// Energy balance of all coupled modes and joints.
    pub energy: EnergyBalance,
    /// Error estimates: for each kind the largest of all coupled modes.
    pub quality: Quality,
    /// Wall-clock time of the integration of the coupled modes, s.
    pub seconds: f64,
}
