//! A measured or identified slider density, given point by point.

use super::backbone::Backbone;
use crate::error::{Error, check};

/// One point of a tabulated density, with the moments of all strengths below it.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct DensityPoint {
    strength: f64,
    density: f64,
    /// ∫ ρ, ∫ ρ φ and ∫ ρ φ² from the first point to this one.
    moments: [f64; 3],
}

/// A density ρ(φ) that is linear between given points, zero outside, with an optional
/// Dirac at the last point.
///
/// `P` holds the points: a slice lends the caller's memory, an array or vector owns it.
///
/// ```
/// use iwan_core::{Backbone, DensityPoint, Tabulated};
/// // A constant density of 1e5 up to 0.01: K_T = 1000, F_S = 1e5 · 0.01²/2.
/// let joint = Tabulated::new(&[0.0, 0.01], &[1e5, 1e5], 0.0, [DensityPoint::default(); 2])?;
/// assert!((joint.initial_stiffness() - 1000.0).abs() < 1e-9);
/// assert!((joint.slip_force() - 5.0).abs() < 1e-12);
/// # Ok::<(), iwan_core::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tabulated<P> {
    points: P,
    dirac: f64,
}

impl<P: AsRef<[DensityPoint]> + AsMut<[DensityPoint]>> Tabulated<P> {
    /// From `strength` φ_i (length, ascending, >= 0) and `density` ρ_i (stiffness/length, >= 0)
    /// at two or more points, and the stiffness `dirac` >= 0 of a slider at the last strength.
    /// `buffer` has as many entries as there are points.
    ///
    /// # Errors
    /// [`Error::Length`], or [`Error::Entry`] with the first entry out of order or range,
    /// or [`Error::OutOfRange`] when the whole density is zero.
    pub fn new(strength: &[f64], density: &[f64], dirac: f64, mut buffer: P) -> Result<Self, Error> {
        let points = buffer.as_mut();
        if strength.len() < 2 {
            return Err(Error::Length { name: "strength", needed: 2, found: strength.len() });
        }
        crate::error::check_length("density", density.len(), strength.len())?;
        crate::error::check_length("buffer", points.len(), strength.len())?;
        check("dirac", dirac, dirac >= 0.0, "must be a finite number >= 0")?;
        for (index, (&value, &rho)) in strength.iter().zip(density).enumerate() {
            let ordered = if index == 0 { value >= 0.0 } else { value > strength[index - 1] };
            if !(ordered && value.is_finite()) {
                let allowed = "must be finite, >= 0 and ascending";
                return Err(Error::Entry { name: "strength", index, value, allowed });
            }
            if !(rho >= 0.0 && rho.is_finite()) {
                let allowed = "must be a finite number >= 0";
                return Err(Error::Entry { name: "density", index, value: rho, allowed });
            }
            let mut point = DensityPoint { strength: value, density: rho, moments: [0.0; 3] };
            if index > 0 {
                point.moments = points[index - 1].moments_up_to(value, rho);
            }
            points[index] = point;
        }
        let joint = Self { points: buffer, dirac };
        let k_t = joint.initial_stiffness();
        check("density", k_t, k_t > 0.0, "must not vanish everywhere")?;
        Ok(joint)
    }
}

impl<P: AsRef<[DensityPoint]>> Tabulated<P> {
    /// Density of the sliders at the strength φ: linear between the points, 0 outside (stiffness/length).
    #[must_use]
    pub fn density(&self, phi: f64) -> f64 {
        let points = self.points.as_ref();
        let next = points.partition_point(|p| p.strength <= phi);
        if next == 0 || phi > self.last().strength {
            return 0.0;
        }
        let Some(b) = points.get(next) else { return self.last().density };
        let a = &points[next - 1];
        a.density + (phi - a.strength) / (b.strength - a.strength) * (b.density - a.density)
    }

    /// Stiffness of the slider at the last point.
    #[must_use]
    pub const fn dirac(&self) -> f64 {
        self.dirac
    }

    fn last(&self) -> &DensityPoint {
        let points = self.points.as_ref();
        &points[points.len() - 1]
    }

    /// ∫ ρ, ∫ ρ φ and ∫ ρ φ² over the strengths below `phi`; they include the Dirac slider once it slips.
    fn moments(&self, phi: f64) -> [f64; 3] {
        let last = self.last();
        if phi >= last.strength {
            let [m0, m1, m2] = last.moments;
            let f = self.dirac * last.strength;
            return [m0 + self.dirac, m1 + f, m2 + f * last.strength];
        }
        let points = self.points.as_ref();
        let next = points.partition_point(|p| p.strength <= phi);
        if next == 0 {
            return [0.0; 3];
        }
        let (a, b) = (&points[next - 1], &points[next]);
        let share = (phi - a.strength) / (b.strength - a.strength);
        a.moments_up_to(phi, a.density + share * (b.density - a.density))
    }
}

impl DensityPoint {
    /// Moments up to `phi`, where the density is `rho` and linear in between: Simpson's rule in
    /// each moment is exact up to the cubic ρ φ².
    fn moments_up_to(&self, phi: f64, rho: f64) -> [f64; 3] {
        let width = phi - self.strength;
        let middle = 0.5 * (phi + self.strength);
        let at_middle = 0.5 * (rho + self.density);
        let simpson = |weight: fn(f64) -> f64| {
            let sum =
                self.density * weight(self.strength) + 4.0 * at_middle * weight(middle) + rho * weight(phi);
            width / 6.0 * sum
        };
        let [m0, m1, m2] = self.moments;
        [m0 + simpson(|_| 1.0), m1 + simpson(|x| x), m2 + simpson(|x| x * x)]
    }
}

impl<P: AsRef<[DensityPoint]>> Backbone for Tabulated<P> {
    fn initial_stiffness(&self) -> f64 {
        self.last().moments[0] + self.dirac
    }

    fn slip_force(&self) -> f64 {
        self.last().moments[1] + self.dirac * self.last().strength
    }

    fn strengths(&self) -> (f64, f64) {
        (self.points.as_ref()[0].strength, self.last().strength)
    }

    fn force(&self, u: f64) -> f64 {
        let [m0, m1, _] = self.moments(u.abs());
        (m1 + (self.initial_stiffness() - m0) * u.abs()).copysign(u)
    }

    fn tangent(&self, u: f64) -> f64 {
        if u.abs() >= self.last().strength {
            0.0
        } else {
            self.initial_stiffness() - self.moments(u.abs())[0]
        }
    }

    /// G = ∫ ρ min(φ, u)(u - min(φ, u)/2) dφ.
    fn energy(&self, u: f64) -> f64 {
        let u = u.abs();
        let [m0, m1, m2] = self.moments(u);
        u * m1 - 0.5 * m2 + 0.5 * (self.initial_stiffness() - m0) * u * u
    }

    fn dissipation(&self, u: f64) -> f64 {
        let u = u.abs();
        let [_, m1, m2] = self.moments(u);
        4.0 * (u * m1 - m2)
    }

    fn is_smooth(&self) -> bool {
        false
    }

    fn stiffness_below(&self, phi: f64) -> f64 {
        self.moments(phi)[0] - if phi == self.last().strength { self.dirac } else { 0.0 }
    }

    fn force_below(&self, phi: f64) -> f64 {
        let last = self.last().strength;
        self.moments(phi)[1] - if phi == last { self.dirac * last } else { 0.0 }
    }
}
