//! Energy balance of a response.

use super::motion::Motion;
use super::newmark::Newmark;
use super::oscillator::Oscillator;
use super::response::{Samples, force_at};

/// Sources and losses of a mode's energy (mass-normalised: length²·mass/s²).
///
/// `initial + input = kinetic + elastic + stored + viscous + friction + residual`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct EnergyBalance {
    /// Kinetic and elastic energy of the initial state, the joint's springs included.
    pub initial: f64,
    /// Work of the applied force.
    pub input: f64,
    /// Kinetic energy ½ q'² at the end.
    pub kinetic: f64,
    /// Elastic energy ½ K_∞ q² at the end.
    pub elastic: f64,
    /// Elastic energy of the joint's springs at the end.
    pub stored: f64,
    /// Work of the viscous damper.
    pub viscous: f64,
    /// Work of friction in the joint.
    pub friction: f64,
    /// Energy that the numerical integration gained (negative) or lost (positive).
    pub residual: f64,
    /// Largest of the initial energy, the net input and the kinetic energy at the end; the residual is measured against it.
    pub scale: f64,
}

/// Energy of the joint's springs before and after a response.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointEnergy {
    /// Energy before the response.
    pub start: f64,
    /// Energy after the response.
    pub end: f64,
}

/// Works of forces along a motion.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Works {
    /// Work of the applied force on the mode.
    pub(crate) force: f64,
    /// Work of the mode on the viscous damper.
    pub(crate) damper: f64,
    /// Work of the mode on the joint, ∫ F_J dq.
    pub(crate) joint: f64,
}

impl EnergyBalance {
    /// |residual| relative to the largest energy in play; 0 when nothing moved.
    #[must_use]
    pub fn error(&self) -> f64 {
        if self.scale > 0.0 { self.residual.abs() / self.scale } else { 0.0 }
    }

    /// The balance of this response followed by `next`, which starts where this one ends.
    #[must_use]
    pub fn then(&self, next: &Self) -> Self {
        Self {
            initial: self.initial,
            input: self.input + next.input,
            viscous: self.viscous + next.viscous,
            friction: self.friction + next.friction,
            residual: self.residual + next.residual,
            scale: self.scale.max(next.scale),
            ..*next
        }
    }

    /// Completes a balance from the motion at the start and at the end, and the works in between.
    pub(crate) fn close(
        oscillator: &Oscillator,
        [start, end]: [Motion; 2],
        stored: JointEnergy,
        works: Works,
    ) -> Self {
        let Works { force: input, damper: viscous, joint: joint_work } = works;
        let kinetic = |at: Motion| 0.5 * at.velocity * at.velocity;
        let elastic = |at: Motion| 0.5 * oscillator.k_inf() * at.displacement * at.displacement;
        let initial = kinetic(start) + elastic(start) + stored.start;
        let gained = (kinetic(end) - kinetic(start)) + (elastic(end) - elastic(start));
        Self {
            initial,
            input,
            kinetic: kinetic(end),
            elastic: elastic(end),
            stored: stored.end,
            viscous,
            friction: joint_work - (stored.end - stored.start),
            residual: input - gained - viscous - joint_work,
            scale: initial.abs().max(input.abs()).max(kinetic(end)),
        }
    }
}

impl Newmark {
    /// Energy balance of a response of this scheme; each work is the sum of mean forces times increments. For average acceleration the
    /// residual is rounding alone; otherwise it is the scheme's numerical damping.
    ///
    /// The input counts the force as the scheme applies it, including the prewarping factor.
    #[must_use]
    pub fn energy(
        &self,
        oscillator: &Oscillator,
        stored: JointEnergy,
        force: &[f64],
        samples: &Samples<'_>,
    ) -> EnergyBalance {
        let (q, v, joint) = (&samples.displacement, &samples.velocity, &samples.joint_force);
        let (Some(&q_end), Some(&v_end)) = (q.last(), v.last()) else {
            return EnergyBalance::default();
        };
        let half_scale = 0.5 * self.force_scale();
        let half_viscous = 0.5 * oscillator.viscous();
        let mut works = Works::default();
        for n in 1..q.len() {
            let dq = q[n] - q[n - 1];
            works.force += half_scale * (force_at(force, n - 1) + force_at(force, n)) * dq;
            works.damper += half_viscous * (v[n - 1] + v[n]) * dq;
            works.joint += 0.5 * (joint[n - 1] + joint[n]) * dq;
        }
        let start = Motion { displacement: q[0], velocity: v[0] };
        let end = Motion { displacement: q_end, velocity: v_end };
        EnergyBalance::close(oscillator, [start, end], stored, works)
    }
}
