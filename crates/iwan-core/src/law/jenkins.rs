//! One spring in series with one friction slider (Jenkins element), of which all Iwan models consist.

use super::backbone::Backbone;
use crate::error::{Error, check};

/// A Jenkins element: stiffness `k_t` up to the slip force `f_s`.
///
/// ```
/// use iwan_core::{Backbone, Jenkins};
/// let joint = Jenkins::new(1000.0, 5.0)?; // slips at 0.005
/// assert_eq!(joint.force(0.002), 2.0);
/// assert_eq!(joint.force(-0.02), -5.0);
/// assert!((joint.dissipation(0.02) - 4.0 * 5.0 * 0.015).abs() < 1e-15);
/// # Ok::<(), iwan_core::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jenkins {
    k_t: f64,
    f_s: f64,
    strength: f64,
}

impl Jenkins {
    /// Stiffness `k_t` > 0 and slip force `f_s` > 0.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with the parameter's name.
    pub fn new(k_t: f64, f_s: f64) -> Result<Self, Error> {
        check("k_t", k_t, k_t > 0.0, "must be a finite number > 0")?;
        check("f_s", f_s, f_s > 0.0, "must be a finite number > 0")?;
        let strength = check("f_s/k_t", f_s / k_t, f_s / k_t > 0.0, "must neither overflow nor vanish")?;
        Ok(Self { k_t, f_s, strength })
    }
}

impl Backbone for Jenkins {
    fn initial_stiffness(&self) -> f64 {
        self.k_t
    }

    fn slip_force(&self) -> f64 {
        self.f_s
    }

    fn strengths(&self) -> (f64, f64) {
        (self.strength, self.strength)
    }

    fn force(&self, u: f64) -> f64 {
        if u.abs() >= self.strength { self.f_s.copysign(u) } else { self.k_t * u }
    }

    fn tangent(&self, u: f64) -> f64 {
        if u.abs() >= self.strength { 0.0 } else { self.k_t }
    }

    fn energy(&self, u: f64) -> f64 {
        let stuck = u.abs().min(self.strength);
        0.5 * self.k_t * stuck * stuck + self.f_s * (u.abs() - stuck)
    }

    /// D = 4 F_S (u - F_S/K_T) once the element slips, 0 before.
    fn dissipation(&self, u: f64) -> f64 {
        4.0 * self.f_s * (u.abs() - self.strength).max(0.0)
    }

    fn is_smooth(&self) -> bool {
        true
    }

    fn stiffness_below(&self, phi: f64) -> f64 {
        if phi > self.strength { self.k_t } else { 0.0 }
    }

    fn force_below(&self, phi: f64) -> f64 {
        if phi > self.strength { self.f_s } else { 0.0 }
    }

    /// K_1 = K_T (θ - sin θ cos θ)/π with cos θ = 1 - 2φ/u.
    fn harmonic_stiffness(&self, u: f64) -> f64 {
        self.k_t * jenkins_harmonic(self.strength / u.abs())
    }
}

/// K_1/k of one Jenkins element at `ratio` = φ/u: 1 while the element sticks (`ratio` >= 1).
pub(crate) fn jenkins_harmonic(ratio: f64) -> f64 {
    if ratio >= 1.0 || ratio.is_nan() {
        return 1.0;
    }
    let theta = 2.0 * libm::asin(libm::sqrt(ratio));
    (theta - libm::sin(theta) * libm::cos(theta)) / core::f64::consts::PI
}
