//! One slider whose friction drops once it moves, per unit of its stiffness.
//!
//! It sticks until its spring is stretched to the static limit φ, slides with the spring at θφ, and sticks again where the
//! motion turns round; the next time it needs the static limit again.

use core::f64::consts::FRAC_2_PI;

use super::jenkins::jenkins_harmonic;

/// The ratio θ of dynamic to static friction, and what follows from it for one slider.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Breakaway {
    /// θ.
    pub(crate) ratio: f64,
}

impl Breakaway {
    /// Strength of the strongest slider that slides in a closed cycle of amplitude `u` > 0 which comes after motions of
    /// amplitudes up to `largest`.
    ///
    /// From rest a slider needs u >= φ to break loose. Once it slides it goes on doing so as long as the way from one
    /// turning point to the next takes its spring from θφ to -φ: 2u >= (1+θ) φ.
    pub(crate) fn reach(self, u: f64, largest: f64) -> f64 {
        u.max(largest.min(2.0 * u / (1.0 + self.ratio)))
    }

    /// Work on the virgin curve up to `u` >= 0.
    pub(crate) fn energy(self, strength: f64, u: f64) -> f64 {
        let stuck = u.min(strength);
        0.5 * stuck * stuck + self.ratio * strength * (u - stuck)
    }

    /// Dissipation of a cycle of amplitude `u` in which it slides: 4θφu + (1+θ)(1-3θ)φ², which is θφ on the way 2u - (1+θ)φ
    /// and ½(1-θ²)φ² each time it breaks loose, twice a cycle.
    pub(crate) fn dissipation(self, strength: f64, u: f64) -> f64 {
        4.0 * self.ratio * strength * u + self.broken() * strength * strength
    }

    /// (1+θ)(1-3θ).
    pub(crate) fn broken(self) -> f64 {
        (1.0 + self.ratio) * (1.0 - 3.0 * self.ratio)
    }

    /// First-harmonic stiffness of a cycle of amplitude `u` > 0 in which it slides: with cos ψ = 1 - (1+θ)φ/u
    /// it is [ψ - sin ψ cos ψ - 2 (1-θ)/(1+θ) sin ψ (1 - cos ψ)]/π.
    pub(crate) fn harmonic(self, strength: f64, u: f64) -> f64 {
        let half = (0.5 * (1.0 + self.ratio) * strength / u).min(1.0);
        let drop = (1.0 - self.ratio) / (1.0 + self.ratio);
        jenkins_harmonic(half) - FRAC_2_PI * drop * 4.0 * half * libm::sqrt(half * (1.0 - half))
    }

    /// How far from the middle the spring of a slider is left, over its strength, that slid and sticks since: the motion goes on about
    /// ±(1-θ)φ/2, to the one side or the other.
    pub(crate) fn left_over(self) -> f64 {
        0.5 * (1.0 - self.ratio)
    }
}
