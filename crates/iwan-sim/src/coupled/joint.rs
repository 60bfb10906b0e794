//! Joints that modes share, as the user describes them, and the check that modes and joints form a possible structure.

use iwan_core::{Backbone, Error, ResidualStiffness};
use nalgebra::{DMatrix, DVector};

use crate::error::SimulationError;
use crate::joint_law::JointLaw;
use crate::mode::Mode;

/// A joint that several modes share.
#[derive(Debug, Clone, PartialEq)]
pub struct SharedJoint {
    /// Name, unique among modes and joints.
    pub name: String,
    /// Its law, in slip and force.
    pub law: JointLaw,
    /// Slip b of the joint in a unit displacement of each mode (mass^-½), in the order of the modes; 0 where a mode does not move the
    /// joint.
    pub participation: Vec<f64>,
    /// Slip ρ of this joint under a unit force on each joint, through the modes left out (length/force), in the order of the joints.
    pub compliance: Vec<f64>,
    /// Slip a of the joint under a unit load, through the modes left out (length/force).
    pub slip_at_force: f64,
}

impl SharedJoint {
    /// A joint with the given slips in each mode and without compliance through modes left out; `joints` is the number of joints.
    #[must_use]
    pub fn new(name: impl Into<String>, law: JointLaw, participation: Vec<f64>, joints: usize) -> Self {
        Self { name: name.into(), law, participation, compliance: vec![0.0; joints], slip_at_force: 0.0 }
    }

    /// Whether mode `index` moves the joint.
    #[must_use]
    pub fn moved_by(&self, index: usize) -> bool {
        self.participation.get(index).is_some_and(|b| *b != 0.0)
    }
}

/// An error in a joint, with the joint's name.
pub(super) fn of_joint(name: &str, error: impl Into<SimulationError>) -> SimulationError {
    SimulationError::Joint { joint: name.to_owned(), source: Box::new(error.into()) }
}

/// Refuses joints whose rows do not match the number of modes and joints.
pub(super) fn check_rows(modes: &[Mode], joints: &[SharedJoint]) -> Result<(), SimulationError> {
    for joint in joints {
        let rows = [
            ("participation", joint.participation.len(), modes.len()),
            ("compliance", joint.compliance.len(), joints.len()),
        ];
        if let Some(&(name, found, needed)) = rows.iter().find(|(_, found, needed)| found != needed) {
            return Err(of_joint(&joint.name, Error::Length { name, needed, found }));
        }
    }
    Ok(())
}

/// Stuck modes and joints as matrices, for static loads.
pub(super) struct Statics {
    /// b: a row per joint, a column per mode.
    pub(super) participation: DMatrix<f64>,
    /// ρ of the joints.
    pub(super) compliance: DMatrix<f64>,
    /// K of each joint.
    pub(super) stiffness: DVector<f64>,
    /// ω² of each mode.
    pub(super) eigenvalues: DVector<f64>,
}

/// Amount by which the largest eigenvalue of flexibility times joint stiffness may exceed its limit of 1. Compliances computed from modes
/// and static loads are accurate to some 1e-6, and parts that slide freely lie exactly at the limit.
const ROUNDING: f64 = 1e-4;

impl Statics {
    /// K^½ (ρ + Σ b bᵀ/ω²) K^½, with the sum over all modes except `without`.
    fn scaled_flexibility(&self, without: Option<usize>) -> DMatrix<f64> {
        let mut flexibility = self.compliance.clone();
        for (r, eigenvalue) in self.eigenvalues.iter().enumerate().filter(|(r, _)| Some(*r) != without) {
            let b = self.participation.column(r);
            flexibility += (b * b.transpose()) / *eigenvalue;
        }
        let root = DMatrix::from_diagonal(&self.stiffness.map(f64::sqrt));
        &root * flexibility * root
    }

    /// Refuses joints that are stiffer than the structure that is said to hold them. When they slip, they would leave the structure a
    /// negative stiffness, and the motion would grow without bound.
    pub(super) fn check(&self, modes: &[&Mode]) -> Result<(), Error> {
        let value = self.scaled_flexibility(None).symmetric_eigenvalues().max();
        let meant = modes.iter().any(|mode| mode.residual == ResidualStiffness::Any);
        if value <= 1.0 + ROUNDING || meant || value.is_nan() {
            return Ok(());
        }
        let name = "stiffness of the joints times the flexibility of the modes (largest eigenvalue)";
        let allowed = "must be at most 1, or nothing holds the modes once the joints slip: lower k_t, participation or \
            compliance (are they in the same units as the frequencies?), keep more modes in place of compliance, or \
            set allow_negative_residual = true in a mode if that is meant";
        Err(Error::OutOfRange { name, value, allowed })
    }

    /// K_T of each mode: the static stiffness that the mode loses when all joints slip freely, bᵀ (K⁻¹ - ρ - Σ b bᵀ/ω² of the other
    /// modes)⁻¹ b.
    pub(super) fn modal_stiffness(&self) -> Vec<f64> {
        let of_mode = |r: usize| {
            let scaled = self.scaled_flexibility(Some(r));
            let unit = DMatrix::identity(scaled.nrows(), scaled.ncols());
            let b = self.participation.column(r).component_mul(&self.stiffness.map(f64::sqrt));
            let solved = (unit - scaled).lu().solve(&b);
            solved.map(|x| b.dot(&x)).filter(|k| k.is_finite()).unwrap_or(0.0)
        };
        (0..self.eigenvalues.len()).map(of_mode).collect()
    }

    /// The matrices of modes and joints whose rows have been checked.
    pub(super) fn new(modes: &[&Mode], joints: &[SharedJoint]) -> Self {
        let (n, j) = (modes.len(), joints.len());
        let square = |mode: &&Mode| (2.0 * std::f64::consts::PI * mode.frequency).powi(2);
        Self {
            participation: DMatrix::from_fn(j, n, |i, r| joints[i].participation[r]),
            compliance: DMatrix::from_fn(j, j, |i, l| joints[i].compliance[l]),
            stiffness: DVector::from_iterator(j, joints.iter().map(|joint| joint.law.initial_stiffness())),
            eigenvalues: DVector::from_iterator(n, modes.iter().map(square)),
        }
    }
}
