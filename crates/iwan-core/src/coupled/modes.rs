//! Modes, the joints that couple them, and the constants of a time step.

use super::definite::{factorise, largest_eigenvalue};
use super::lanes::{LANES, Lanes, groups};
use crate::error::{Error, check, check_length};
use crate::step::{Newmark, Oscillator};

/// A stuck mode of a coupled motion, mass-normalised, with its time-stepping scheme.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoupledMode {
    /// Circular frequency with all joints stuck and viscous damping: an [`Oscillator`] without a joint.
    pub oscillator: Oscillator,
    /// Average acceleration, prewarped to this mode or plain.
    pub scheme: Newmark,
    /// Mass-normalised mode shape at the load: modal force = shape · force.
    pub shape_at_force: f64,
}

/// A joint that couples modes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoupledJoint<'a> {
    /// Initial stiffness K of its law.
    pub stiffness: f64,
    /// Slip b of the joint in a unit displacement of each mode.
    pub participation: &'a [f64],
    /// Slip ρ of this joint under a unit force N on each joint, through the modes left out: one row of a symmetric matrix.
    pub compliance: &'a [f64],
    /// Slip a of the joint under a unit load, through the modes left out.
    pub slip_at_force: f64,
}

/// Stuck modes, the joints that couple them, and the constants of an average-acceleration step.
///
/// Let h be the step and σ the factor on the force of each mode's [`Newmark`] scheme, e = h ζ ω + h² ω²/4, d = 1/(1 + e), and let a bar
/// mark the mean over a step. The mean velocity of a step is
///
/// v̄ = v + d \[h/2 (σ φ f̄ - ω² q - Σ b N) - e v\] - d h/4 Σ b ΔN,   q' = q + h v̄,   v' = 2 v̄ - v,
///
/// and the slips move by Δs = Δs* - c ΔN. Here Δs* = Σ b h v̄* + a Δf is their increment with N held constant (v̄* is v̄ with ΔN = 0), and
/// c = ρ + B (d h²/4) Bᵀ. For any laws of initial stiffness K the equation has one solution if λ_max(K^½ c K^½) < 1, because all tangents
/// of a law lie between 0 and K.
///
/// `S` is memory that the caller provides: an array of groups of four, or a vector.
///
/// ```
/// use iwan_core::{CoupledJoint, CoupledMode, CoupledModes, Newmark, Oscillator, ResidualStiffness};
/// let mode = |frequency: f64| -> Result<CoupledMode, iwan_core::Error> {
///     let oscillator = Oscillator::new(frequency, 0.0, 0.0, ResidualStiffness::Positive)?;
///     Ok(CoupledMode { oscillator, scheme: Newmark::average_acceleration(1e-5)?, shape_at_force: 1.0 })
/// };
/// let modes = [mode(124.0)?, mode(696.0)?];
/// let joint = |compliance| CoupledModes::new(
///     &modes,
///     &[CoupledJoint { stiffness: 3e4, participation: &[1.0, -4.9], compliance, slip_at_force: 0.0 }],
///     |_| [[0.0; 4]; 1],
/// );
/// assert!(joint(&[1e-5]).is_ok());
/// assert!(joint(&[4e-5]).is_err()); // K ρ = 1.2: the step would have no unique solution
/// # Ok::<(), iwan_core::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct CoupledModes<S> {
    modes: usize,
    joints: usize,
    /// Time step h of each mode, s.
    pub(super) step: S,
    /// d h/2.
    pub(super) push: S,
    /// d h/4.
    pub(super) give: S,
    /// d e.
    pub(super) drag: S,
    /// ω².
    pub(super) stiffness: S,
    /// 2 ζ ω.
    pub(super) viscous: S,
    /// φ, and σ φ.
    pub(super) load: S,
    pub(super) drive: S,
    /// b, and b h: for each joint, all groups of modes in a row.
    pub(super) participation: S,
    pub(super) reach: S,
    /// K, a, ρ and c of the joints.
    joint_stiffness: S,
    slip_at_force: S,
    compliance: S,
    coupling: S,
}

/// Largest relative difference of ρ_jl and ρ_lj that counts as rounding of the given numbers; a larger one is refused.
const ASYMMETRY: f64 = 1e-9;

impl<S: AsRef<[Lanes]> + AsMut<[Lanes]>> CoupledModes<S> {
    /// Takes modes and joints. `storage` must return room for the requested number of groups: at most one joint times the [`groups`] of
    /// modes, or the groups of the joints' matrix.
    ///
    /// # Errors
    /// [`Error::Length`] for no modes or joints, rows that do not fit, or too little room; [`Error::Entry`] and [`Error::OutOfRange`] for
    /// numbers that are not finite, a joint that slips in no mode, compliances that are not symmetric, and λ_max(K^½ c K^½) >= 1;
    /// [`Error::Unsupported`] for schemes other than average acceleration.
    pub fn new(
        modes: &[CoupledMode],
        joints: &[CoupledJoint<'_>],
        storage: impl Fn(usize) -> S,
    ) -> Result<Self, Error> {
        checked(modes, joints)?;
        let (n, j) = (modes.len(), joints.len());
        let room = |values: usize| -> Result<S, Error> {
            let (needed, mut room) = (groups(values), storage(groups(values)));
            let found = room.as_ref().len();
            if found < needed {
                return Err(Error::Length { name: "storage", needed, found });
            }
            room.as_mut().as_flattened_mut().fill(0.0);
            Ok(room)
        };
        let (per_mode, matrix) = (|| room(n), || room(j * j));
        let by_joint = || room(j * groups(n) * LANES);
        let mut coupled = Self {
            modes: n,
            joints: j,
            step: per_mode()?,
            push: per_mode()?,
            give: per_mode()?,
            drag: per_mode()?,
            stiffness: per_mode()?,
            viscous: per_mode()?,
            load: per_mode()?,
            drive: per_mode()?,
            participation: by_joint()?,
            reach: by_joint()?,
            joint_stiffness: room(j)?,
            slip_at_force: room(j)?,
            compliance: matrix()?,
            coupling: matrix()?,
        };
        modes.iter().enumerate().for_each(|(r, mode)| coupled.take_mode(r, mode));
        joints.iter().enumerate().for_each(|(i, joint)| coupled.take_joint(i, joint));
        coupled.couple();
        coupled.check_coupling(matrix()?, [matrix()?, room(2 * j)?])?;
        Ok(coupled)
    }

    fn take_mode(&mut self, r: usize, mode: &CoupledMode) {
        let CoupledMode { oscillator, scheme, shape_at_force } = mode;
        let (h, omega, c) = (scheme.step(), oscillator.omega0(), oscillator.viscous());
        let excess = 0.5 * h * c + 0.25 * h * h * omega * omega;
        let inverse = 1.0 / (1.0 + excess);
        let set = |row: &mut S, value: f64| row.as_mut().as_flattened_mut()[r] = value;
        set(&mut self.step, h);
        set(&mut self.push, 0.5 * h * inverse);
        set(&mut self.give, 0.25 * h * inverse);
        set(&mut self.drag, excess * inverse);
        set(&mut self.stiffness, omega * omega);
        set(&mut self.viscous, c);
        set(&mut self.load, *shape_at_force);
        set(&mut self.drive, scheme.force_scale() * shape_at_force);
    }

    fn take_joint(&mut self, i: usize, joint: &CoupledJoint<'_>) {
        let (first, j) = (i * groups(self.modes) * LANES, self.joints);
        let steps = self.step.as_ref().as_flattened();
        for (r, b) in joint.participation.iter().enumerate() {
            self.participation.as_mut().as_flattened_mut()[first + r] = *b;
            self.reach.as_mut().as_flattened_mut()[first + r] = b * steps[r];
        }
        self.joint_stiffness.as_mut().as_flattened_mut()[i] = joint.stiffness;
        self.slip_at_force.as_mut().as_flattened_mut()[i] = joint.slip_at_force;
        self.compliance.as_mut().as_flattened_mut()[i * j..(i + 1) * j].copy_from_slice(joint.compliance);
    }

    /// c = ρ + B (d h²/4) Bᵀ.
    fn couple(&mut self) {
        let (lanes, j) = (groups(self.modes) * LANES, self.joints);
        let (reach, b) = (self.reach.as_ref().as_flattened(), self.participation.as_ref().as_flattened());
        let (give, rho) = (self.give.as_ref().as_flattened(), self.compliance.as_ref().as_flattened());
        for (k, c) in self.coupling.as_mut().as_flattened_mut()[..j * j].iter_mut().enumerate() {
            let (one, other) = (k / j * lanes, k % j * lanes);
            let of_modes = (0..self.modes).map(|r| give[r] * (reach[one + r] * b[other + r]));
            *c = rho[k] + of_modes.sum::<f64>();
        }
    }

    /// Checks that I - K^½ c K^½ is positive definite.
    fn check_coupling(&self, mut matrix: S, [mut unit, mut work]: [S; 2]) -> Result<(), Error> {
        let (j, k, c) = (self.joints, self.joint_stiffness(), self.coupling());
        let scaled = |i: usize, l: usize| libm::sqrt(k[i]) * c[i * j + l] * libm::sqrt(k[l]);
        let (matrix, unit) = (matrix.as_mut().as_flattened_mut(), unit.as_mut().as_flattened_mut());
        for at in 0..j * j {
            let (i, l) = (at / j, at % j);
            matrix[at] = if i == l { 1.0 } else { 0.0 } - scaled(i, l);
            // Rounding can leave a compliance of rank one with an eigenvalue of -1e-16; 1e-9 on the diagonal keeps that from being refused.
            unit[at] = scaled(i, l) + if i == l { 1e-9 } else { 0.0 };
        }
        if !factorise(j, unit) {
            let (name, value) = ("compliance", self.compliance.as_ref().as_flattened()[0]);
            let allowed = "the joints' compliances must form a positive semi-definite matrix, as forces on springs do \
                work: compliance[i][l]^2 <= compliance[i][i] * compliance[l][l]";
            return Err(Error::OutOfRange { name, value, allowed });
        }
        if factorise(j, matrix) {
            return Ok(());
        }
        let value = largest_eigenvalue(j, scaled, work.as_mut().as_flattened_mut());
        let allowed = "must be below 1, or a step has no unique solution: keep more modes beside the joints, and give \
            them less compliance";
        Err(Error::OutOfRange {
            name: "compliance times joint stiffness (largest eigenvalue)",
            value,
            allowed,
        })
    }

    /// Number of modes.
    #[must_use]
    pub const fn modes(&self) -> usize {
        self.modes
    }

    /// Number of joints.
    #[must_use]
    pub const fn joints(&self) -> usize {
        self.joints
    }

    /// K of each joint.
    pub(super) fn joint_stiffness(&self) -> &[f64] {
        &self.joint_stiffness.as_ref().as_flattened()[..self.joints]
    }

    /// a of each joint.
    pub(super) fn slip_at_force(&self) -> &[f64] {
        &self.slip_at_force.as_ref().as_flattened()[..self.joints]
    }

    /// ρ, row by row.
    pub(super) fn compliance(&self) -> &[f64] {
        &self.compliance.as_ref().as_flattened()[..self.joints * self.joints]
    }

    /// c, row by row.
    pub(super) fn coupling(&self) -> &[f64] {
        &self.coupling.as_ref().as_flattened()[..self.joints * self.joints]
    }
}

fn checked(modes: &[CoupledMode], joints: &[CoupledJoint<'_>]) -> Result<(), Error> {
    for (name, found) in [("modes", modes.len()), ("joints", joints.len())] {
        if found == 0 {
            return Err(Error::Length { name, needed: 1, found });
        }
    }
    for mode in modes {
        if !mode.scheme.is_average_acceleration() {
            return Err(Error::Unsupported {
                what: "coupled modes are stepped with beta = 0.25 and gamma = 0.5 only",
            });
        }
        check("shape_at_force", mode.shape_at_force, true, "must be a finite number")?;
    }
    for (i, joint) in joints.iter().enumerate() {
        check("stiffness", joint.stiffness, joint.stiffness > 0.0, "must be a finite number > 0")?;
        check("slip_at_force", joint.slip_at_force, true, "must be a finite number")?;
        check_length("participation", joint.participation.len(), modes.len())?;
        check_length("compliance", joint.compliance.len(), joints.len())?;
        let finite = |name, row: &[f64]| match row.iter().position(|x| !x.is_finite()) {
            Some(index) => {
                Err(Error::Entry { name, index, value: row[index], allowed: "must be a finite number" })
            }
            None => Ok(()),
        };
        finite("participation", joint.participation)?;
        finite("compliance", joint.compliance)?;
        if joint.participation.iter().all(|b| *b == 0.0) {
            let allowed = "must not be 0 in all modes: the joint would not move";
            return Err(Error::Entry { name: "participation", index: 0, value: 0.0, allowed });
        }
        for (l, other) in joints.iter().enumerate() {
            let (value, back) = (joint.compliance[l], other.compliance.get(i).copied().unwrap_or(f64::NAN));
            let size = value.abs().max(back.abs());
            if (value - back).abs() > ASYMMETRY * size || (i == l && value < 0.0) {
                let allowed = "must be >= 0 on the diagonal, and the same between two joints both ways";
                return Err(Error::Entry { name: "compliance", index: l, value, allowed });
            }
        }
    }
    Ok(())
}
