//! A stop behind a gap.

use crate::error::{Error, check};
use crate::law::jenkins_harmonic;

/// Pinning: a spring k behind a gap g on either side, f = k (|u| - g) sign u for |u| > g, without dissipation. It stands for a bolt's shank
/// that meets its hole, or for a contact that stiffens. Mass-normalised.
///
/// Its first-harmonic stiffness at the amplitude a > g is K_1 = (2k/π) (θ - sin θ cos θ) with cos θ = g/a (S. Natsiavas, Periodic response
/// and stability of oscillators with symmetric trilinear restoring force, J. Sound Vib. 134:315, 1989, has the exact motion with
/// clearance).
///
/// ```
/// use iwan_core::Pinning;
/// let stop = Pinning::new(1000.0, 0.01)?;
/// assert_eq!((stop.force(0.01), stop.force(-0.02)), (0.0, -10.0));
/// assert_eq!(stop.energy(0.02), 0.05);
/// # Ok::<(), iwan_core::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pinning {
    k: f64,
    gap: f64,
}

impl Pinning {
    /// Stiffness `k` >= 0 (1/s²) beyond the `gap` > 0 (mass^½·length).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with the parameter's name.
    pub fn new(k: f64, gap: f64) -> Result<Self, Error> {
        check("k", k, k >= 0.0, "must be a finite number >= 0")?;
        check(
            "gap",
            gap,
            gap > 0.0,
            "must be a finite number > 0 (a spring without gap is in the mode's frequency)",
        )?;
        Ok(Self { k, gap })
    }

    /// Stiffness k.
    #[must_use]
    pub const fn k(&self) -> f64 {
        self.k
    }

    /// Gap g.
    #[must_use]
    pub const fn gap(&self) -> f64 {
        self.gap
    }

    /// How far |u| exceeds the gap, >= 0.
    fn beyond(&self, u: f64) -> f64 {
        (libm::fabs(u) - self.gap).max(0.0)
    }

    /// Force at the displacement `u`.
    #[must_use]
    pub fn force(&self, u: f64) -> f64 {
        (self.k * self.beyond(u)).copysign(u)
    }

    /// df/du: k beyond the gap, 0 within.
    #[must_use]
    pub fn tangent(&self, u: f64) -> f64 {
        if libm::fabs(u) > self.gap { self.k } else { 0.0 }
    }

    /// Energy ½ k (|u| - g)² of the spring beyond the gap.
    #[must_use]
    pub fn energy(&self, u: f64) -> f64 {
        let x = self.beyond(u);
        0.5 * self.k * x * x
    }

    /// Mean of the force over the displacements from `a` to `b`, which is work over distance, computed without cancellation.
    #[must_use]
    pub fn mean_force(&self, a: f64, b: f64) -> f64 {
        if a == b {
            return self.force(a);
        }
        let side = |a: f64, b: f64| {
            let (x, y) = ((a - self.gap).max(0.0), (b - self.gap).max(0.0));
            (y - x) / (b - a) * (y + x)
        };
        0.5 * self.k * (side(a, b) - side(-a, -b))
    }

    /// First-harmonic stiffness at the amplitude `a`.
    #[must_use]
    pub fn harmonic_stiffness(&self, a: f64) -> f64 {
        let a = libm::fabs(a);
        if a <= self.gap { 0.0 } else { 2.0 * self.k * jenkins_harmonic(0.5 * ((a - self.gap) / a)) }
    }
}
