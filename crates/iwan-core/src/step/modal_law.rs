//! The whole law of a mode in terms of one cycle: first-harmonic stiffness and dissipation against amplitude.

use core::f64::consts::PI;

use super::oscillator::Oscillator;
use crate::law::Backbone;
use crate::parts::{Part, sum_of_parts};

/// The sum of a mode's linear part, its joint and its parts.
///
/// ```
/// use iwan_core::{Coulomb, Jenkins, ModalLaw, Oscillator, Part, ResidualStiffness};
/// let joint = Jenkins::new(1000.0, 5.0)?;
/// let mode = Oscillator::new(10.0, 0.0, 1000.0, ResidualStiffness::Positive)?;
/// let parts = [Part::from(Coulomb::new(0.5)?)];
/// let law = ModalLaw::new(mode, Some(&joint), &parts);
/// // The Jenkins element sticks at this amplitude: only dry friction takes energy, 4 F a.
/// assert!((law.frequency(0.002) - mode.omega0()).abs() < 1e-12);
/// assert!((law.dissipation(0.002, mode.omega0()) - 4.0 * 0.5 * 0.002).abs() < 1e-17);
/// # Ok::<(), iwan_core::Error>(())
/// ```
#[derive(Debug)]
pub struct ModalLaw<'a, B> {
    oscillator: Oscillator,
    joint: Option<&'a B>,
    parts: &'a [Part],
}

// Not derived: a derived `Clone` would require that the borrowed law is `Clone`.
impl<B> Clone for ModalLaw<'_, B> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<B> Copy for ModalLaw<'_, B> {}

impl<'a, B: Backbone> ModalLaw<'a, B> {
    /// The law of `oscillator` with `parts` and with the `joint` whose K_T the oscillator was made with.
    #[must_use]
    pub const fn new(oscillator: Oscillator, joint: Option<&'a B>, parts: &'a [Part]) -> Self {
        Self { oscillator, joint, parts }
    }

    /// The linear part.
    #[must_use]
    pub const fn oscillator(&self) -> &Oscillator {
        &self.oscillator
    }

    /// First-harmonic stiffness of the joint and the parts at the amplitude `a` and circular frequency `w` (rad/s), without K_∞.
    #[must_use]
    pub fn added_stiffness(&self, a: f64, w: f64) -> f64 {
        let joint = self.joint.map_or(0.0, |law| law.harmonic_stiffness(a));
        joint + sum_of_parts(self.parts, |part| part.harmonic_stiffness(a, w))
    }

    /// Energy lost per cycle to the joint and the parts, without the viscous damper.
    #[must_use]
    pub fn added_dissipation(&self, a: f64, w: f64) -> f64 {
        let joint = self.joint.map_or(0.0, |law| law.dissipation(a));
        joint + sum_of_parts(self.parts, |part| part.dissipation(a, w))
    }

    /// Energy of the joint's and the parts' springs at the turning point of a closed cycle of amplitude `a`.
    #[must_use]
    pub fn added_energy(&self, a: f64) -> f64 {
        let joint = self.joint.map_or(0.0, |law| law.energy_at_turn(a));
        joint + sum_of_parts(self.parts, |part| part.energy(a))
    }

    /// First-harmonic stiffness of the whole mode: K_∞ + K_1(a) + Σ of the parts, 1/s².
    #[must_use]
    pub fn harmonic_stiffness(&self, a: f64, w: f64) -> f64 {
        self.oscillator.k_inf() + self.added_stiffness(a, w)
    }

    /// Energy lost per cycle by the whole mode: π c ω a² to the viscous damper, D to the joint, and the sum over the parts.
    #[must_use]
    pub fn dissipation(&self, a: f64, w: f64) -> f64 {
        PI * self.oscillator.viscous() * w * a * a + self.added_dissipation(a, w)
    }

    /// Circular frequency ω(a), rad/s, where ω² is the harmonic stiffness; NaN where a softening spring makes that negative.
    #[must_use]
    pub fn frequency(&self, a: f64) -> f64 {
        // The stiffness of the present parts does not depend on ω.
        libm::sqrt(self.harmonic_stiffness(a, self.oscillator.omega0()))
    }

    /// Decay rate -a'/a of a free motion of amplitude `a` > 0, 1/s: D/(2π a² ω) with the viscous damper included in D.
    #[must_use]
    pub fn decay_rate(&self, a: f64) -> f64 {
        let viscous = 0.5 * self.oscillator.viscous();
        // Where a² underflows, the joint's friction is negligible beside the damper, and dry friction has already stopped the motion.
        if a * a <= f64::MIN_POSITIVE {
            return viscous;
        }
        let w = self.frequency(a);
        self.added_dissipation(a, w) / (2.0 * PI * a * a * w) + viscous
    }

    /// Damping ratio D/(2π ω² a²) of a cycle of amplitude `a` > 0, all losses together.
    #[must_use]
    pub fn damping_ratio(&self, a: f64) -> f64 {
        self.decay_rate(a) / self.frequency(a)
    }
}
