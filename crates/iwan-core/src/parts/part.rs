//! One part of a modal law, of any kind, and sums over several parts.

use super::coulomb::Coulomb;
use super::pinning::Pinning;
use super::power_damping::PowerDamping;
use super::power_spring::PowerSpring;

/// A part of a modal law without memory, beside the joint.
///
/// ```
/// use iwan_core::{Part, PowerDamping, PowerSpring, sum_of_parts};
/// let parts = [Part::from(PowerDamping::new(0.5, 1.0)?), Part::from(PowerSpring::new(200.0, 3.0)?)];
/// let stiffness = sum_of_parts(&parts, |part| part.harmonic_stiffness(0.1, 10.0));
/// let lost = sum_of_parts(&parts, |part| part.dissipation(0.1, 10.0));
/// assert!((stiffness - 1.5).abs() < 1e-14);
/// assert!((lost - core::f64::consts::PI * 0.5 * 10.0 * 0.01).abs() < 1e-15);
/// # Ok::<(), iwan_core::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Part {
    /// c |v|^n sign v.
    PowerDamping(PowerDamping),
    /// Dry friction of constant size.
    Coulomb(Coulomb),
    /// k |u|^(m-1) u.
    Spring(PowerSpring),
    /// A spring beyond a gap.
    Pinning(Pinning),
}

/// The sum of a property over all parts: 0 when there are none.
#[must_use]
pub fn sum_of_parts(parts: &[Part], property: impl Fn(&Part) -> f64) -> f64 {
    parts.iter().map(property).sum::<f64>() + 0.0
}

impl Part {
    /// The elastic force: the part of the force that depends on the displacement `u` alone. Only springs and pinning have one.
    #[must_use]
    pub fn elastic_force(&self, u: f64) -> f64 {
        match self {
            Self::Spring(part) => part.force(u),
            Self::Pinning(part) => part.force(u),
            Self::PowerDamping(_) | Self::Coulomb(_) => 0.0,
        }
    }

    /// Force of velocity damping at the velocity `v`. Dry friction, which jumps at v = 0, is not included: see
    /// [`friction`](Self::friction).
    #[must_use]
    pub fn damping_force(&self, v: f64) -> f64 {
        if let Self::PowerDamping(part) = self { part.force(v) } else { 0.0 }
    }

    /// Slope of [`damping_force`](Self::damping_force).
    #[must_use]
    pub fn damping_slope(&self, v: f64) -> f64 {
        if let Self::PowerDamping(part) = self { part.slope(v) } else { 0.0 }
    }

    /// Size of the dry friction. It acts against the velocity; at rest it balances any force up to this size.
    #[must_use]
    pub fn friction(&self) -> f64 {
        if let Self::Coulomb(part) = self { part.size() } else { 0.0 }
    }

    /// Force at the displacement `u` and the velocity `v`, with the sign that opposes positive values. At v = 0 dry friction has no
    /// definite value and is left out.
    #[must_use]
    pub fn force(&self, u: f64, v: f64) -> f64 {
        let friction = if v == 0.0 { 0.0 } else { self.friction().copysign(v) };
        self.elastic_force(u) + self.damping_force(v) + friction
    }

    /// Energy stored at the displacement `u`: 0 for a damper, negative for a spring that softens.
    #[must_use]
    pub fn energy(&self, u: f64) -> f64 {
        match self {
            Self::Spring(part) => part.energy(u),
            Self::Pinning(part) => part.energy(u),
            Self::PowerDamping(_) | Self::Coulomb(_) => 0.0,
        }
    }

    /// d/du of the elastic force.
    #[must_use]
    pub fn tangent(&self, u: f64) -> f64 {
        match self {
            Self::Spring(part) => part.tangent(u),
            Self::Pinning(part) => part.tangent(u),
            Self::PowerDamping(_) | Self::Coulomb(_) => 0.0,
        }
    }

    /// Mean of the elastic force over the displacements from `a` to `b`.
    #[must_use]
    pub fn mean_force(&self, a: f64, b: f64) -> f64 {
        match self {
            Self::Spring(part) => part.mean_force(a, b),
            Self::Pinning(part) => part.mean_force(a, b),
            Self::PowerDamping(_) | Self::Coulomb(_) => 0.0,
        }
    }

    /// First-harmonic stiffness (1/πa) ∮ f cos θ dθ in a motion a cos θ of circular frequency `w` (rad/s): the force in
    /// phase with the displacement, over the amplitude `a`. None of the present parts depends on `w` here.
    #[must_use]
    pub fn harmonic_stiffness(&self, a: f64, _w: f64) -> f64 {
        match self {
            Self::Spring(part) => part.harmonic_stiffness(a),
            Self::Pinning(part) => part.harmonic_stiffness(a),
            Self::PowerDamping(_) | Self::Coulomb(_) => 0.0,
        }
    }

    /// Energy lost in one cycle of amplitude `a` at the circular frequency `w` (rad/s).
    #[must_use]
    pub fn dissipation(&self, a: f64, w: f64) -> f64 {
        match self {
            Self::PowerDamping(part) => part.dissipation(a, w),
            Self::Coulomb(part) => part.dissipation(a),
            Self::Spring(_) | Self::Pinning(_) => 0.0,
        }
    }
}

impl From<PowerDamping> for Part {
    fn from(part: PowerDamping) -> Self {
        Self::PowerDamping(part)
    }
}

impl From<Coulomb> for Part {
    fn from(part: Coulomb) -> Self {
        Self::Coulomb(part)
    }
}

impl From<PowerSpring> for Part {
    fn from(part: PowerSpring) -> Self {
        Self::Spring(part)
    }
}

impl From<Pinning> for Part {
    fn from(part: Pinning) -> Self {
        Self::Pinning(part)
    }
}
