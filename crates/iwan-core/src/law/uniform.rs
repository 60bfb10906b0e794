//! Iwan's 1966 bilinear model: slider strengths spread evenly over a band.
//!
//! W. D. Iwan, A distributed-element model for hysteresis and its steady-state
//! dynamic response, J. Appl. Mech. 33(4):893, 1966, doi:10.1115/1.3625199.

use super::backbone::{Backbone, PowerLaw};
use crate::error::{Error, check};

/// Sliders of equal stiffness, strengths uniform over φ_mean (1 ± width).
///
/// `width` = 1 is the full band 0 … 2 F_S/K_T (the four-parameter joint with χ = 0, β = 0); `width` -> 0 approaches a Jenkins element.
///
/// ```
/// use iwan_core::{Backbone, Uniform};
/// let joint = Uniform::new(1000.0, 5.0, 1.0)?; // strengths from 0 to 0.01
/// assert!((joint.force(0.005) - (5.0 - 1.25)).abs() < 1e-12); // K_T u - ½ (K_T/0.01) u²
/// assert_eq!(joint.force(0.02), 5.0);
/// # Ok::<(), iwan_core::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Uniform {
    k_t: f64,
    f_s: f64,
    weakest: f64,
    strongest: f64,
    density: f64,
}

impl Uniform {
    /// Stiffness `k_t` > 0, slip force `f_s` > 0, relative half `width` 0 < w <= 1 of the band.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with the parameter's name.
    pub fn new(k_t: f64, f_s: f64, width: f64) -> Result<Self, Error> {
        check("k_t", k_t, k_t > 0.0, "must be a finite number > 0")?;
        check("f_s", f_s, f_s > 0.0, "must be a finite number > 0")?;
        check("width", width, width > 0.0 && width <= 1.0, "must satisfy 0 < width <= 1")?;
        let mean = check("f_s/k_t", f_s / k_t, f_s / k_t > 0.0, "must neither overflow nor vanish")?;
        let density = check("k_t/width", k_t / (2.0 * mean * width), true, "width is too small for a band")?;
        Ok(Self { k_t, f_s, weakest: mean * (1.0 - width), strongest: mean * (1.0 + width), density })
    }

    /// Density of the sliders at the strength φ: constant in the band, 0 outside (stiffness/length).
    #[must_use]
    pub fn density(&self, phi: f64) -> f64 {
        if (self.weakest..=self.strongest).contains(&phi) { self.density } else { 0.0 }
    }

    /// How far the displacement |u| exceeds the weakest strength (length); 0 below it.
    fn beyond_weakest(&self, u: f64) -> f64 {
        (u.abs() - self.weakest).max(0.0)
    }
}

impl Backbone for Uniform {
    fn initial_stiffness(&self) -> f64 {
        self.k_t
    }

    fn slip_force(&self) -> f64 {
        self.f_s
    }

    fn strengths(&self) -> (f64, f64) {
        (self.weakest, self.strongest)
    }

    fn force(&self, u: f64) -> f64 {
        if u.abs() >= self.strongest {
            return self.f_s.copysign(u);
        }
        let x = self.beyond_weakest(u);
        self.k_t * u - (0.5 * self.density * x * x).copysign(u)
    }

    fn tangent(&self, u: f64) -> f64 {
        if u.abs() >= self.strongest { 0.0 } else { self.k_t - self.density * self.beyond_weakest(u) }
    }

    fn energy(&self, u: f64) -> f64 {
        let within = u.abs().min(self.strongest);
        let x = self.beyond_weakest(within);
        0.5 * self.k_t * within * within - self.density * x * x * x / 6.0 + self.f_s * (u.abs() - within)
    }

    /// D = 4 ∫ ρ φ (u - φ) dφ over the strengths below u.
    fn dissipation(&self, u: f64) -> f64 {
        let u = u.abs();
        let x = self.beyond_weakest(u.min(self.strongest));
        let below = x * (self.weakest + 0.5 * x);
        let second = x * (self.weakest * self.weakest + x * (self.weakest + x / 3.0));
        4.0 * self.density * (u * below - second)
    }

    fn is_smooth(&self) -> bool {
        true
    }

    fn stiffness_below(&self, phi: f64) -> f64 {
        self.density * self.beyond_weakest(phi.min(self.strongest))
    }

    fn force_below(&self, phi: f64) -> f64 {
        let x = self.beyond_weakest(phi.min(self.strongest));
        self.density * x * (self.weakest + 0.5 * x)
    }

    fn power_law(&self) -> Option<PowerLaw> {
        let limit = self.strongest;
        (self.weakest == 0.0).then_some(PowerLaw {
            stiffness: self.k_t,
            coefficient: 0.5 * self.density,
            exponent: 2.0,
            limit,
        })
    }
}
