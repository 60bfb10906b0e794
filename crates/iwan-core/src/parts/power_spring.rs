//! A spring whose force grows with a power of the displacement.

use super::cosine_power::{MOST_EXPONENT, quarter_integral};
use crate::error::{Error, check};
use crate::quadrature::Rule;

/// Elastic spring f = k |u|^(m-1) u without dissipation, mass-normalised. m = 3 is Duffing's spring; k < 0 softens, as a contact that opens
/// does.
///
/// Its first-harmonic stiffness is (4/π) k a^(m-1) ∫ cos^(m+1) θ dθ over a quarter of a cycle,
///
/// K_1 = (2/√π) k a^(m-1) Γ(m/2 + 1)/Γ(m/2 + 3/2),
///
/// which is (3/4) k a² for m = 3 (A. H. Nayfeh and D. T. Mook, Nonlinear Oscillations, 1979, Sec. 2.3). The exponent m is above 1, so that
/// the spring does not change the mode's frequency at small amplitude.
///
/// ```
/// use iwan_core::PowerSpring;
/// let duffing = PowerSpring::new(200.0, 3.0)?;
/// assert!((duffing.force(-0.1) + 0.2).abs() < 1e-15);
/// assert!((duffing.energy(0.1) - 200.0 * 1e-4 / 4.0).abs() < 1e-17);
/// assert!((duffing.harmonic_stiffness(0.1) - 1.5).abs() < 1e-14);
/// # Ok::<(), iwan_core::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PowerSpring {
    k: f64,
    exponent: f64,
    /// (4/π) k ∫ cos^(m+1) over a quarter of a cycle.
    harmonic: f64,
}

/// Two displacements are near neighbours if their relative distance times m + 1 is at most this. The mean force between near neighbours is
/// a quadrature, because the difference of the energies would cancel. At 0.5 the five nodes leave an error of 1e-16, and the difference has
/// lost only one digit.
const NEAR: f64 = 0.5;

impl PowerSpring {
    /// Coefficient `k` of either sign in (1/s²) per (mass^½·length)^(m-1), `exponent` 1 < m <= 100.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with the parameter's name.
    pub fn new(k: f64, exponent: f64) -> Result<Self, Error> {
        check("k", k, true, "must be a finite number")?;
        let allowed = "must satisfy 1 < exponent <= 100 (the linear spring is in the mode's frequency)";
        check("exponent", exponent, exponent > 1.0 && exponent <= MOST_EXPONENT, allowed)?;
        let harmonic = 4.0 / core::f64::consts::PI * k * quarter_integral(exponent + 1.0);
        Ok(Self { k, exponent, harmonic })
    }

    /// Coefficient k.
    #[must_use]
    pub const fn k(&self) -> f64 {
        self.k
    }

    /// Exponent m.
    #[must_use]
    pub const fn exponent(&self) -> f64 {
        self.exponent
    }

    /// Force at the displacement `u`.
    #[must_use]
    pub fn force(&self, u: f64) -> f64 {
        self.k * libm::pow(libm::fabs(u), self.exponent).copysign(u)
    }

    /// df/du = m k |u|^(m-1).
    #[must_use]
    pub fn tangent(&self, u: f64) -> f64 {
        self.exponent * self.k * libm::pow(libm::fabs(u), self.exponent - 1.0)
    }

    /// Energy k |u|^(m+1)/(m+1) of the spring; negative for k < 0.
    #[must_use]
    pub fn energy(&self, u: f64) -> f64 {
        self.k * libm::pow(libm::fabs(u), self.exponent + 1.0) / (self.exponent + 1.0)
    }

    /// Mean of the force over the displacements from `a` to `b`, which is work over distance, computed without cancellation.
    #[must_use]
    pub fn mean_force(&self, a: f64, b: f64) -> f64 {
        const RULE: Rule<5> = Rule::gauss_legendre();
        let largest = libm::fabs(a).max(libm::fabs(b));
        if libm::fabs(b - a) * (self.exponent + 1.0) <= NEAR * largest {
            return 0.5 * RULE.integrate(-1.0, 1.0, |s| self.force(0.5 * ((a + b) + s * (b - a))));
        }
        if a == b { self.force(a) } else { (self.energy(b) - self.energy(a)) / (b - a) }
    }

    /// First-harmonic stiffness at the amplitude `a`.
    #[must_use]
    pub fn harmonic_stiffness(&self, a: f64) -> f64 {
        self.harmonic * libm::pow(libm::fabs(a), self.exponent - 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_force_is_work_over_way() {
        for (k, m) in [(3.0, 3.0), (-2.0, 1.4), (0.7, 7.3), (1.0, 100.0)] {
            let spring = PowerSpring::new(k, m).unwrap();
            for (a, b) in [(0.3, 0.9), (-0.2, 0.7), (0.5, 0.5), (1.0, 1.0 + 0.4999 / (m + 1.0)), (0.0, 1e-3)]
            {
                let fine = Rule::<64>::gauss_legendre();
                // The kink of the force at u = 0 is one end of the integration.
                let work = |u: f64| fine.integrate(0.0, u, |x| spring.force(x));
                let mean = if a == b { spring.force(a) } else { (work(b) - work(a)) / (b - a) };
                let found = spring.mean_force(a, b);
                assert!((found - mean).abs() <= 1e-8 * mean.abs(), "{k} {m} {a} {b}: {found} {mean}");
            }
            // Just below and just above the limit between quadrature and difference.
            let (near, far) = (1.0 + 0.499_999 / (m + 1.0), 1.0 + 0.500_001 / (m + 1.0));
            let (x, y) = (spring.mean_force(1.0, near), spring.mean_force(1.0, far));
            assert!((x / y - 1.0).abs() < 2e-6, "{m}: {x} {y}");
            let exact = (spring.energy(near) - spring.energy(1.0)) / (near - 1.0);
            assert!((x / exact - 1.0).abs() < 1e-13, "{m}: {x} {exact}");
        }
    }
}
