//! Newmark-β time integration of a mode with any hysteretic joint.
//!
//! N. M. Newmark, J. Eng. Mech. Div. ASCE 85(3):67, 1959; Deaner et al. ran β = 1/4, γ = 1/2
//! (average acceleration).

use super::oscillator::Oscillator;
use super::response::{Samples, force_at};
use crate::error::{Error, check};
use crate::memory::Hysteresis;

/// The scheme's parameters for one step size h.
///
/// With c = 2 ζ_v ω0, displacement q, velocity v, acceleration a, applied force p, joint force F and Δq = q_1 -
/// q_0, the step from sample 0 to sample 1 is
///
/// [1/(βh²) + γc/(βh) + K_∞] Δq + F_1 - F_0 =
/// p_1 + [1/(βh) - c (1 - γ/β)] v_0 + [1/(2β) - 1 - c h (1 - γ/(2β))] a_0 - K_∞ q_0 - F_0,
///
/// v_1 = γ/(βh) Δq + (1 - γ/β) v_0 + h (1 - γ/(2β)) a_0,
///
/// a_1 = p_1 - c v_1 - K_∞ q_1 - F_1.
///
/// The force p acts in the direction of q; spring, damper and joint act against it: F is positive where the joint
/// pulls back from a positive q.
///
/// Why this form: the unknown is the increment Δq, so the digits of the displacement itself do not cancel in the step's equation, and
/// [`Hysteresis::solve`] solves that equation as it stands. The acceleration is never integrated; it follows from the equation of motion at
/// every step, so rounding does not accumulate: each step starts from a state in balance.
///
/// ```
/// use iwan_core::{Newmark, NoJoint, Oscillator, ResidualStiffness, Samples};
/// // A linear mode of 1 Hz, released at q = 1 and prewarped: exact after a quarter period.
/// let mode = Oscillator::new(1.0, 0.0, 0.0, ResidualStiffness::Positive)?;
/// let (mut q, mut v, mut a, mut f) = ([0.0; 26], [0.0; 26], [0.0; 26], [0.0; 26]);
/// let mut out = Samples { displacement: &mut q, velocity: &mut v, acceleration: &mut a, joint_force: &mut f };
/// let scheme = Newmark::prewarped(0.01, mode.omega0())?;
/// scheme.integrate(&mode, &NoJoint, &mut 1.0, 0.0, &[], &mut out)?;
/// assert!(q[25].abs() < 1e-12);
/// assert!((v[25] + mode.omega0()).abs() < 1e-10);
/// # Ok::<(), iwan_core::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Newmark {
    beta: f64,
    gamma: f64,
    /// Time step h in the formulas (s): dt, or the prewarped step h'.
    step: f64,
    /// Factor on the applied force: 1 for the plain scheme, ω0 dt / sin(ω0 dt) for the prewarped one.
    force_scale: f64,
}

/// Factors of one step in the equations of [`Newmark`]: of Δq, v_0 and a_0 in v_1, and of v_0 and a_0 in the load.
struct Coefficients {
    velocity_increment: f64,
    velocity_velocity: f64,
    velocity_acceleration: f64,
    load_velocity: f64,
    load_acceleration: f64,
}

impl Newmark {
    /// Average acceleration, β = 1/4 and γ = 1/2: unconditionally stable, no numerical damping,
    /// period error (ω dt)²/12.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] when `dt` (s) is not a finite number > 0.
    pub fn average_acceleration(dt: f64) -> Result<Self, Error> {
        Self::new(dt, 0.25, 0.5)
    }

    /// The general scheme: 0 < `beta` <= 1/2 and 1/2 <= `gamma` <= 1. γ > 1/2 gives numerical damping; with β < γ/2 the scheme is stable
    /// only for steps that are short against the period.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with the name of the parameter.
    pub fn new(dt: f64, beta: f64, gamma: f64) -> Result<Self, Error> {
        let step = check("time step", dt, dt > 0.0, "must be a finite number of seconds > 0")?;
        check("beta", beta, beta > 0.0 && beta <= 0.5, "must satisfy 0 < beta <= 0.5 (Newmark)")?;
        check("gamma", gamma, (0.5..=1.0).contains(&gamma), "must satisfy 0.5 <= gamma <= 1 (Newmark)")?;
        Ok(Self { beta, gamma, step, force_scale: 1.0 })
    }

    /// Average acceleration without period error for the small-amplitude oscillator.
    ///
    /// The formulas use the step h' = (2/ω0) tan(ω0 dt/2), which maps the rule's frequency back onto ω0 (the bilinear transform's
    /// prewarping). The force is multiplied by ω0 dt / sin(ω0 dt), so that the response to an impulse is exact. That factor changes the
    /// effect of a lasting force, such as a static displacement, by the part (ω0 dt)²/6 (1e-5 at 124 Hz and dt = 1e-5 s), which is of
    /// second order like the scheme.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless 0 < ω0 dt < π (more than two samples a cycle).
    pub fn prewarped(dt: f64, omega0: f64) -> Result<Self, Error> {
        let angle = omega0 * dt;
        let fits = angle > 0.0 && angle < core::f64::consts::PI;
        check("time step", dt, dt > 0.0 && fits, "must be > 0 and shorter than half a period of the mode")?;
        let step = 2.0 / omega0 * libm::tan(0.5 * angle);
        Ok(Self { beta: 0.25, gamma: 0.5, step, force_scale: angle / libm::sin(angle) })
    }

    /// Factor on the applied force (1 unless prewarped).
    #[must_use]
    pub const fn force_scale(&self) -> f64 {
        self.force_scale
    }

    /// Whether the scheme is prewarped. False also for steps so short that prewarping changes no bit.
    #[must_use]
    pub fn is_prewarped(&self) -> bool {
        self.force_scale != 1.0
    }

    /// The same scheme over a `share` of the step, for an oscillator of the circular frequency `omega0` (rad/s); a prewarped scheme stays
    /// prewarped.
    pub(crate) fn shortened(&self, omega0: f64, share: f64) -> Self {
        if share == 1.0 {
            return *self;
        }
        if self.force_scale == 1.0 {
            return Self { step: share * self.step, ..*self };
        }
        let angle = share * 2.0 * libm::atan(0.5 * omega0 * self.step);
        Self { step: 2.0 / omega0 * libm::tan(0.5 * angle), force_scale: angle / libm::sin(angle), ..*self }
    }

    /// Time step h in the formulas, s.
    pub(crate) const fn step(&self) -> f64 {
        self.step
    }

    /// Whether the scheme is average acceleration (β = 1/4, γ = 1/2).
    pub(crate) fn is_average_acceleration(&self) -> bool {
        self.beta == 0.25 && self.gamma == 0.5
    }

    /// Coefficient of Δq in the equation of one step, without the joint.
    fn effective_stiffness(&self, oscillator: &Oscillator) -> f64 {
        let (h, c) = (self.step, oscillator.viscous());
        1.0 / (self.beta * h * h) + c * self.gamma / (self.beta * h) + oscillator.k_inf()
    }

    /// Returns that coefficient, after a check that the equation of one step has a unique solution.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] when a negative K_∞ outweighs the inertia term.
    pub(crate) fn checked_effective_stiffness(&self, oscillator: &Oscillator) -> Result<f64, Error> {
        let stiffness = self.effective_stiffness(oscillator);
        check("time step", self.step, stiffness > 0.0, "is too long for a mode with negative K_inf")?;
        Ok(stiffness)
    }

    /// Factors of one step for the viscous coefficient `c` (1/s).
    fn coefficients(&self, c: f64) -> Coefficients {
        let (b, g, h) = (self.beta, self.gamma, self.step);
        let (velocity_velocity, velocity_acceleration) = (1.0 - g / b, h * (1.0 - 0.5 * g / b));
        Coefficients {
            velocity_increment: g / (b * h),
            velocity_velocity,
            velocity_acceleration,
            load_velocity: 1.0 / (b * h) - c * velocity_velocity,
            load_acceleration: (0.5 / b - 1.0) - c * velocity_acceleration,
        }
    }

    /// Integrates over the samples from the initial `velocity` and the displacement in the joint's `state`; returns the final velocity.
    ///
    /// `force` holds one value per time step, the first at the initial state; after its end the force is zero.
    ///
    /// # Errors
    /// [`Error::Length`] when the buffers disagree; [`Error::OutOfRange`] as in the constructors.
    pub fn integrate<State, J: Hysteresis<State>>(
        &self,
        oscillator: &Oscillator,
        joint: &J,
        state: &mut State,
        velocity: f64,
        force: &[f64],
        out: &mut Samples<'_>,
    ) -> Result<f64, Error> {
        let samples = out.checked_len()?;
        let stiffness = self.checked_effective_stiffness(oscillator)?;
        let (k, c) = (oscillator.k_inf(), oscillator.viscous());
        let factors = self.coefficients(c);
        let (mut q, mut v) = (joint.displacement(state), velocity);
        let mut joint_force = joint.joint_force(state);
        let mut p = force_at(force, 0);
        let mut a = p - c * v - (k * q + joint_force);
        out.set(0, [q, v, a, joint_force]);
        for n in 1..samples {
            // The acceleration of the scheme is the one that balances the force times the prewarping factor.
            let a_scheme = a + (self.force_scale - 1.0) * p;
            p = force_at(force, n);
            let known = (self.force_scale * p + factors.load_velocity * v) - (k * q + joint_force);
            let dq = joint.solve(state, stiffness, known + factors.load_acceleration * a_scheme);
            q = joint.displacement(state);
            v = factors.velocity_increment * dq
                + (factors.velocity_velocity * v + factors.velocity_acceleration * a_scheme);
            joint_force = joint.joint_force(state);
            a = p - c * v - (k * q + joint_force);
            out.set(n, [q, v, a, joint_force]);
        }
        Ok(v)
    }
}
