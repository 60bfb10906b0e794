//! Segalman's four-parameter Iwan joint {K_T, F_S, χ, β}.
//!
//! Density ρ(φ) = R φ^χ [H(φ) - H(φ - φ_max)] + S δ(φ - φ_max) (Deaner et al., Eq. 3;
//! Segalman, J. Appl. Mech. 72(5):752, 2005, doi:10.1115/1.1989354).

use core::f64::consts::PI;

use super::backbone::{Backbone, PowerLaw};
use super::cosine_moment::{cosine_moment, linear_moment};
use crate::error::{Error, check};

/// A four-parameter Iwan joint.
///
/// Units are the user's own consistent set: K_T in force/length (or 1/s² for a
/// mass-normalised mode), F_S in force (or mass^½·length/s²), φ_max in length.
///
/// ```
/// use iwan_core::{Backbone, FourParameter};
/// // Table 1 of Deaner et al.
/// let joint = FourParameter::new(2.75e5, 300.0, -0.3, 0.02)?;
/// assert!((joint.phi_max() - 0.002577161258360168).abs() < 1e-17);
/// assert!((joint.force(2.0 * joint.phi_max()) - 300.0).abs() < 1e-12);
/// # Ok::<(), iwan_core::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FourParameter {
    pub(super) k_t: f64,
    pub(super) f_s: f64,
    pub(super) chi: f64,
    beta: f64,
    pub(super) phi_max: f64,
    /// K_T - S: the stiffness of the power-law part.
    pub(super) k_power: f64,
    s: f64,
    /// Factor g: the first-harmonic stiffness softens g times as much as the secant stiffness.
    harmonic: f64,
}

impl FourParameter {
    /// From the physical parameters: stiffness `k_t` > 0, slip force `f_s` > 0, power
    /// -1 < `chi` <= 1 (the literature's range is -1 < χ <= 0) and `beta` >= 0, the ratio of
    /// the stiffness of the Dirac slider to that of the power-law part.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with the parameter's name.
    pub fn new(k_t: f64, f_s: f64, chi: f64, beta: f64) -> Result<Self, Error> {
        check("k_t", k_t, k_t > 0.0, "must be a finite number > 0")?;
        check("f_s", f_s, f_s > 0.0, "must be a finite number > 0")?;
        check("chi", chi, chi > -1.0 && chi <= 1.0, "must satisfy -1 < chi <= 1")?;
        check("beta", beta, beta >= 0.0, "must be a finite number >= 0")?;
        let c = (chi + 1.0) / (chi + 2.0);
        let phi_max = f_s * (1.0 + beta) / (k_t * (beta + c));
        check("phi_max", phi_max, phi_max > 0.0, "f_s/k_t must neither overflow nor vanish")?;
        // F_S/φ_max = K_T (β + c)/(1 + β), hence S = K_T β/(1 + β) and K_T - S = K_T/(1 + β).
        let (k_power, s) = (k_t / (1.0 + beta), k_t * (beta / (1.0 + beta)));
        Ok(Self { k_t, f_s, chi, beta, phi_max, k_power, s, harmonic: first_harmonic_factor(chi) })
    }

    /// From the density: coefficient `r` > 0 and power `chi` of R φ^χ, its end `phi_max` > 0
    /// and the strength `s` >= 0 of the Dirac there.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with the parameter's name.
    pub fn from_density(r: f64, chi: f64, phi_max: f64, s: f64) -> Result<Self, Error> {
        check("r", r, r > 0.0, "must be a finite number > 0")?;
        check("chi", chi, chi > -1.0 && chi <= 1.0, "must satisfy -1 < chi <= 1")?;
        check("phi_max", phi_max, phi_max > 0.0, "must be a finite number > 0")?;
        check("s", s, s >= 0.0, "must be a finite number >= 0")?;
        let k_power = r * libm::pow(phi_max, chi + 1.0) / (chi + 1.0);
        let k_t = k_power + s;
        check("k_t", k_t, k_power > 0.0, "r phi_max^(chi+1) must neither overflow nor vanish")?;
        let f_s = phi_max * (k_power * (chi + 1.0) / (chi + 2.0) + s);
        check("f_s", f_s, f_s > 0.0, "k_t phi_max must neither overflow nor vanish")?;
        check("beta", s / k_power, true, "s / (k_t - s) must not overflow")?;
        Ok(Self {
            k_t,
            f_s,
            chi,
            beta: s / k_power,
            phi_max,
            k_power,
            s,
            harmonic: first_harmonic_factor(chi),
        })
    }

    /// Joint stiffness K_T, with all sliders stuck.
    #[must_use]
    pub const fn k_t(&self) -> f64 {
        self.k_t
    }

    /// Slip force F_S, with all sliders slipping.
    #[must_use]
    pub const fn f_s(&self) -> f64 {
        self.f_s
    }

    /// Power χ of the density; dissipation per cycle in micro-slip grows with u^(χ+3).
    #[must_use]
    pub const fn chi(&self) -> f64 {
        self.chi
    }

    /// Ratio β = S (χ+1) / (R φ_max^(χ+1)).
    #[must_use]
    pub const fn beta(&self) -> f64 {
        self.beta
    }

    /// Displacement φ_max = F_S (1+β) / (K_T (β + (χ+1)/(χ+2))) at which macro-slip begins.
    #[must_use]
    pub const fn phi_max(&self) -> f64 {
        self.phi_max
    }

    /// Density coefficient R, in stiffness / length^(χ+1).
    #[must_use]
    pub fn r(&self) -> f64 {
        self.k_power * (self.chi + 1.0) / libm::pow(self.phi_max, self.chi + 1.0)
    }

    /// Strength S = K_T β/(1+β) of the Dirac at φ_max, a stiffness.
    #[must_use]
    pub const fn s(&self) -> f64 {
        self.s
    }

    /// Density ρ(φ) = R φ^χ of the sliders at the strength φ >= 0 (Eq. 3), 0 beyond φ_max, where the Dirac of
    /// strength [`s`](Self::s) stands; infinite at φ = 0 for χ < 0.
    ///
    /// ```
    /// let joint = iwan_core::FourParameter::from_density(2e5, 0.0, 0.01, 500.0)?;
    /// assert!((joint.density(0.004) / 2e5 - 1.0).abs() < 1e-14);
    /// assert_eq!(joint.density(0.02), 0.0);
    /// # Ok::<(), iwan_core::Error>(())
    /// ```
    #[must_use]
    pub fn density(&self, phi: f64) -> f64 {
        if !(0.0..=self.phi_max).contains(&phi) {
            return 0.0;
        }
        // R φ^χ = (K_T - S) (χ+1)/φ_max (φ/φ_max)^χ.
        self.k_power * (self.chi + 1.0) / self.phi_max * libm::pow(phi / self.phi_max, self.chi)
    }

    /// Dissipation per cycle in macro-slip as printed in Eq. 17 of Deaner et al.: 4 u F_S.
    ///
    /// The formula is only the asymptote for u >> φ_max. At the onset of macro-slip it is 2.8, 4.7 and 5.3 times the exact value
    /// ([`Backbone::dissipation`]) for Table 1 and for modes 1 and 3 of Table 2; at 10 φ_max it is still 7 to 9 % too high.
    #[must_use]
    pub fn dissipation_printed_eq17(&self, u: f64) -> f64 {
        4.0 * u.abs() * self.f_s
    }

    /// (|u|/φ_max)^(χ+1), the only power in the micro-slip formulas.
    pub(super) fn power(&self, u: f64) -> f64 {
        libm::pow(u.abs() / self.phi_max, self.chi + 1.0)
    }
}

/// Factor g = (4/π) [2 I(2χ+6) - I(2χ+4)] of the softening in K_1, with I(a) = √π Γ((a+1)/2) / Γ(a/2 + 1).
///
/// I(a + 2) = I(a) (a + 1)/(a + 2) turns the bracket into I(2χ+4) (χ+2)/(χ+3).
fn first_harmonic_factor(chi: f64) -> f64 {
    let a = 2.0 * chi + 4.0;
    let i = libm::sqrt(core::f64::consts::PI) * libm::tgamma(0.5 * (a + 1.0)) / libm::tgamma(0.5 * a + 1.0);
    4.0 / core::f64::consts::PI * i * (chi + 2.0) / (chi + 3.0)
}

/// The micro-slip formulas in terms of p = (|u|/φ_max)^(χ+1).
impl FourParameter {
    #[inline]
    fn force_from_power(&self, u: f64, p: f64) -> f64 {
        u * (self.k_t - self.k_power / (self.chi + 2.0) * p)
    }

    #[inline]
    pub(super) fn tangent_from_power(&self, p: f64) -> f64 {
        self.k_t - self.k_power * p
    }

    #[inline]
    pub(super) fn dissipation_from_power(&self, u: f64, p: f64) -> f64 {
        let c = self.chi;
        4.0 * self.k_power * (c + 1.0) / ((c + 2.0) * (c + 3.0)) * p * u * u
    }

    #[inline]
    pub(super) fn harmonic_from_power(&self, p: f64) -> f64 {
        self.k_t - self.harmonic * self.k_power / (self.chi + 2.0) * p
    }

    /// Whether all sliders slip at `u` on the virgin curve.
    #[inline]
    pub(super) fn slipping(&self, u: f64) -> bool {
        u.abs() >= self.phi_max
    }
}

impl FourParameter {
    /// Complete beta function B(χ + 5/2, ½), recovered from the micro-slip factor g.
    pub(super) fn complete_beta(&self) -> f64 {
        let p = self.chi + 2.0;
        0.25 * PI * self.harmonic * (p + 1.0) / p
    }

    /// K_1 = -(4/πu) ∫F(u sin²(θ/2)) cos θ dθ from 0 to π, with F = K_T z - C z^(χ+2) up to φ_max and F_S beyond.
    fn harmonic_in_macro_slip(&self, u: f64) -> f64 {
        let (x, p) = (self.phi_max / u, self.chi + 2.0);
        let beta = self.complete_beta();
        let sticking = self.k_t * linear_moment(x);
        let softening = self.k_power / p * cosine_moment(p, beta, x);
        let sliding = 2.0 * self.f_s * libm::sqrt(x * (1.0 - x));
        -4.0 / (PI * u) * ((sticking - softening) * self.phi_max - sliding)
    }
}

impl Backbone for FourParameter {
    fn initial_stiffness(&self) -> f64 {
        self.k_t
    }

    fn slip_force(&self) -> f64 {
        self.f_s
    }

    fn strengths(&self) -> (f64, f64) {
        (0.0, self.phi_max)
    }

    /// F = u [K_T - R u^(χ+1) / ((χ+1)(χ+2))] in micro-slip (Eq. 16 times F_S), F_S beyond.
    fn force(&self, u: f64) -> f64 {
        if self.slipping(u) { self.f_s.copysign(u) } else { self.force_from_power(u, self.power(u)) }
    }

    /// K = K_T - R u^(χ+1) / (χ+1) in micro-slip, 0 beyond.
    fn tangent(&self, u: f64) -> f64 {
        if self.slipping(u) { 0.0 } else { self.tangent_from_power(self.power(u)) }
    }

    fn energy(&self, u: f64) -> f64 {
        let micro = |u: f64, p: f64| {
            u * u * (0.5 * self.k_t - self.k_power * p / ((self.chi + 2.0) * (self.chi + 3.0)))
        };
        if self.slipping(u) {
            micro(self.phi_max, 1.0) + self.f_s * (u.abs() - self.phi_max)
        } else {
            micro(u, self.power(u))
        }
    }

    /// D = 4 R u^(χ+3) / ((χ+2)(χ+3)) in micro-slip: Eq. 15 with its prefix mended to F_S²/K_T.
    /// D = 4 F_S u - 4 [R φ_max^(χ+3)/(χ+3) + S φ_max²] = D(φ_max) + 4 F_S (u - φ_max) in macro-slip,
    /// where the printed Eq. 17 has 4 F_S u.
    fn dissipation(&self, u: f64) -> f64 {
        if self.slipping(u) {
            self.dissipation_from_power(self.phi_max, 1.0) + 4.0 * self.f_s * (u.abs() - self.phi_max)
        } else {
            self.dissipation_from_power(u, self.power(u))
        }
    }

    /// K_1 = K_T - g R u^(χ+1) / ((χ+1)(χ+2)) in micro-slip with g = (4/π) [2 I(2χ+6) - I(2χ+4)], I(a) = √π
    /// Γ((a+1)/2) / Γ(a/2 + 1); beyond φ_max by an incomplete beta function.
    fn harmonic_stiffness(&self, u: f64) -> f64 {
        if self.slipping(u) {
            return self.harmonic_in_macro_slip(u.abs());
        }
        self.harmonic_from_power(self.power(u))
    }

    fn stiffness_and_dissipation(&self, u: f64) -> (f64, f64) {
        if self.slipping(u) {
            return (self.harmonic_stiffness(u), self.dissipation(u));
        }
        let p = self.power(u);
        (self.harmonic_from_power(p), self.dissipation_from_power(u, p))
    }

    fn force_and_tangent(&self, u: f64) -> (f64, f64) {
        if self.slipping(u) {
            return (self.f_s.copysign(u), 0.0);
        }
        let p = self.power(u);
        (self.force_from_power(u, p), self.tangent_from_power(p))
    }

    fn is_smooth(&self) -> bool {
        true
    }

    fn stiffness_below(&self, phi: f64) -> f64 {
        self.k_power * self.power(phi).min(1.0) + if phi > self.phi_max { self.s } else { 0.0 }
    }

    fn force_below(&self, phi: f64) -> f64 {
        if phi > self.phi_max {
            return self.f_s;
        }
        self.k_power * (self.chi + 1.0) / (self.chi + 2.0) * self.power(phi) * phi
    }

    fn power_law(&self) -> Option<PowerLaw> {
        let exponent = self.chi + 2.0;
        Some(PowerLaw {
            stiffness: self.k_t,
            coefficient: self.k_power / exponent / libm::pow(self.phi_max, self.chi + 1.0),
            exponent,
            limit: self.phi_max,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::backbone::first_harmonic;
    use super::*;

    #[test]
    fn first_harmonic_in_macro_slip_is_that_of_the_quadrature() {
        for chi in [-0.95, -0.5, -0.183, 0.0, 0.7] {
            for beta in [0.0, 0.02, 5.0] {
                let joint = FourParameter::new(4.45e4, 239.4, chi, beta).unwrap();
                for ratio in [1.0 + 1e-9, 1.01, 1.3, 1.45, 1.6, 3.0, 50.0, 1e4] {
                    let u = ratio * joint.phi_max();
                    let (found, exact) = (joint.harmonic_stiffness(u), first_harmonic(&joint, u));
                    assert!((found / exact - 1.0).abs() < 1e-11, "{chi} {beta} {ratio}: {found} {exact}");
                }
            }
        }
    }
}
