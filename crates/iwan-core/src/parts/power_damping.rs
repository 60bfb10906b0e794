//! A damper whose force grows with a power of the velocity.

use super::cosine_power::{MOST_EXPONENT, quarter_integral};
use crate::error::{Error, check};

/// Velocity damping f = c |v|^n sign v, mass-normalised: n = 1 is a viscous damper, n = 2 a quadratic one, as in air and water.
/// [`Coulomb`](super::Coulomb) is its limit n -> 0.
///
/// A motion a cos ωt loses c (ωa)^(n+1)/ω ∮ |sin θ|^(n+1) dθ in one cycle,
///
/// D = 2 √π c ω^n a^(n+1) Γ(n/2 + 1)/Γ(n/2 + 3/2),
///
/// which is π c ω a² for n = 1 and (8/3) c ω² a³ for n = 2 (A. H. Nayfeh and D. T. Mook, Nonlinear Oscillations, 1979,
/// Sec. 3.3).
///
/// ```
/// use iwan_core::PowerDamping;
/// let quadratic = PowerDamping::new(3.0, 2.0)?;
/// assert_eq!(quadratic.force(-0.5), -0.75);
/// assert!((quadratic.dissipation(0.1, 10.0) / (8.0 / 3.0 * 3.0 * 100.0 * 1e-3) - 1.0).abs() < 1e-14);
/// # Ok::<(), iwan_core::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PowerDamping {
    c: f64,
    n: f64,
    /// 4 c ∫ cos^(n+1) over a quarter of a cycle.
    cycle: f64,
}

impl PowerDamping {
    /// Coefficient `c` >= 0 in (mass^½·length/s²) per (mass^½·length/s)^n, exponent 0 < `n` <= 100.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with the parameter's name.
    pub fn new(c: f64, n: f64) -> Result<Self, Error> {
        check("c", c, c >= 0.0, "must be a finite number >= 0")?;
        let allowed = "must satisfy 0 < n <= 100 (for n = 0 use Coulomb friction)";
        check("n", n, n > 0.0 && n <= MOST_EXPONENT, allowed)?;
        Ok(Self { c, n, cycle: 4.0 * c * quarter_integral(n + 1.0) })
    }

    /// Coefficient c.
    #[must_use]
    pub const fn c(&self) -> f64 {
        self.c
    }

    /// Exponent n.
    #[must_use]
    pub const fn n(&self) -> f64 {
        self.n
    }

    /// Force at the velocity `v`, positive where it acts against a positive velocity.
    #[must_use]
    pub fn force(&self, v: f64) -> f64 {
        (self.c * libm::pow(libm::fabs(v), self.n)).copysign(v)
    }

    /// df/dv = n c |v|^(n-1); infinite at v = 0 for n < 1.
    #[must_use]
    pub fn slope(&self, v: f64) -> f64 {
        self.n * self.c * libm::pow(libm::fabs(v), self.n - 1.0)
    }

    /// Energy lost in one cycle of amplitude `a` at the circular frequency `w` (rad/s).
    #[must_use]
    pub fn dissipation(&self, a: f64, w: f64) -> f64 {
        let a = libm::fabs(a);
        self.cycle * libm::pow(w * a, self.n) * a
    }
}
