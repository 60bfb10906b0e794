//! The modal oscillator with an Iwan joint.
//!
//! q'' + 2 ζ_v ω0 q' + K_∞ q + F_J(q) = f(t) with K_∞ = ω0² - K_T (Deaner et al., Eq. 5),
//! mass-normalised: q in mass^½·length, f in mass^½·length/s².

use crate::error::{Error, check};

/// Small-amplitude frequency, viscous damping and residual stiffness of a mass-normalised mode. The joint is a separate value.
///
/// ```
/// use iwan_core::{Oscillator, ResidualStiffness};
/// let mode = Oscillator::new(10.0, 0.01, 1000.0, ResidualStiffness::Positive)?;
/// assert!((mode.k_inf() - (62.83185307179586_f64.powi(2) - 1000.0)).abs() < 1e-9);
/// assert!((mode.viscous() - 1.2566370614359172).abs() < 1e-12);
/// // A joint stiffer than its mode is refused unless it is meant.
/// assert!(Oscillator::new(10.0, 0.01, 4000.0, ResidualStiffness::Positive).is_err());
/// # Ok::<(), iwan_core::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Oscillator {
    omega0: f64,
    damping_ratio: f64,
    k_inf: f64,
}

/// Whether a joint that is stiffer than its mode is allowed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ResidualStiffness {
    /// K_∞ = ω0² - K_T must be positive.
    #[default]
    Positive,
    /// K_∞ <= 0 is allowed: then nothing but the joint holds the mass.
    Any,
}

impl Oscillator {
    /// Small-amplitude frequency `frequency` (Hz, > 0), viscous ratio `damping_ratio` (0 <= ζ_v < 1,
    /// in parallel with the joint) and the joint's stiffness `k_t` = K_T (1/s²).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with the name of the quantity.
    pub fn new(
        frequency: f64,
        damping_ratio: f64,
        k_t: f64,
        residual: ResidualStiffness,
    ) -> Result<Self, Error> {
        check("frequency", frequency, frequency > 0.0, "must be a finite number of hertz > 0")?;
        let below_one = (0.0..1.0).contains(&damping_ratio);
        check("damping_ratio", damping_ratio, below_one, "must satisfy 0 <= damping_ratio < 1")?;
        let omega0 = 2.0 * core::f64::consts::PI * frequency;
        let k_inf = omega0 * omega0 - k_t;
        let allowed = "the joint stiffness must be below (2 pi frequency)^2, so that K_inf = omega0^2 - k_t > 0, \
            unless a residual stiffness <= 0 is allowed explicitly";
        check("k_t", k_t, k_inf > 0.0 || residual == ResidualStiffness::Any, allowed)?;
        Ok(Self { omega0, damping_ratio, k_inf })
    }

    /// Small-amplitude circular frequency ω0, rad/s.
    #[must_use]
    pub const fn omega0(&self) -> f64 {
        self.omega0
    }

    /// Viscous damping ratio ζ_v.
    #[must_use]
    pub const fn damping_ratio(&self) -> f64 {
        self.damping_ratio
    }

    /// Residual stiffness K_∞ = ω0² - K_T when all sliders slip, 1/s².
    #[must_use]
    pub const fn k_inf(&self) -> f64 {
        self.k_inf
    }

    /// Viscous coefficient c = 2 ζ_v ω0, 1/s.
    #[must_use]
    pub fn viscous(&self) -> f64 {
        2.0 * self.damping_ratio * self.omega0
    }
}
