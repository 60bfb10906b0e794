//! One slider (a spring in series with a friction element) whose friction drops once it slides; all quantities are per unit of its
//! stiffness.
//!
//! The slider sticks until its spring is stretched to the static limit φ. Then it slides, with the spring stretched to θφ, until the motion
//! turns round; there it sticks again, and needs the static limit φ again to break loose.

use core::f64::consts::FRAC_2_PI;

use super::jenkins::jenkins_harmonic;

/// The ratio θ of dynamic to static friction, and what follows from it for one slider.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Breakaway {
    /// θ.
    pub(crate) ratio: f64,
}

impl Breakaway {
    /// Strength of the strongest slider that slides in a closed cycle of amplitude `u` > 0, after motions of amplitudes up to `largest`.
    ///
    /// From rest a slider needs u >= φ to break loose. A slider that has broken loose keeps sliding in each later cycle in which the way 2u
    /// between turning points takes its spring from θφ to -φ: 2u >= (1+θ) φ.
    pub(crate) fn reach(self, u: f64, largest: f64) -> f64 {
        u.max(largest.min(2.0 * u / (1.0 + self.ratio)))
    }

    /// Work on the virgin curve up to `u` >= 0.
    pub(crate) fn energy(self, strength: f64, u: f64) -> f64 {
        let stuck = u.min(strength);
        0.5 * stuck * stuck + self.ratio * strength * (u - stuck)
    }

    /// Dissipation of a cycle of amplitude `u` in which the slider slides: 4θφu + (1+θ)(1-3θ)φ². In each half cycle the friction θφ acts
    /// over the way 2u - (1+θ)φ, and breaking loose dissipates ½(1-θ²)φ².
    pub(crate) fn dissipation(self, strength: f64, u: f64) -> f64 {
        4.0 * self.ratio * strength * u + self.broken() * strength * strength
    }

    /// Coefficient (1+θ)(1-3θ) of φ² in the dissipation of a cycle.
    pub(crate) fn broken(self) -> f64 {
        (1.0 + self.ratio) * (1.0 - 3.0 * self.ratio)
    }

    /// First-harmonic stiffness in a cycle of amplitude `u` > 0 in which the slider slides: [ψ - sin ψ cos ψ - 2 (1-θ)/(1+θ) sin ψ (1 - cos
    /// ψ)]/π with cos ψ = 1 - (1+θ)φ/u.
    pub(crate) fn harmonic(self, strength: f64, u: f64) -> f64 {
        let half = (0.5 * (1.0 + self.ratio) * strength / u).min(1.0);
        let drop = (1.0 - self.ratio) / (1.0 + self.ratio);
        jenkins_harmonic(half) - FRAC_2_PI * drop * 4.0 * half * libm::sqrt(half * (1.0 - half))
    }

    /// Stretch, over the strength φ, that remains in the spring of a slider which slid before and sticks now. In later small cycles the
    /// spring moves about ±(1-θ)φ/2, with the sign of its last sliding.
    pub(crate) fn left_over(self) -> f64 {
        0.5 * (1.0 - self.ratio)
    }
}
