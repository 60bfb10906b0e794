//! The virgin curve of a joint law, in closed form.
//!
//! A parallel-series Iwan model is completely given by its virgin (backbone) curve F(u): its slider density is ρ(u) = -F''(u), and Masing's
//! rule gives all its loops. A further family of joints is one file that implements [`Backbone`]. A law whose friction drops once its
//! sliders slip does not obey Masing's rule: it says so by [`Backbone::friction_ratio`] and brings formulas for its own cycles.

use crate::error::Error;
use crate::quadrature::Rule;

/// Micro-slip of the form F(u) = stiffness·u - coefficient·u^exponent for |u| <= limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PowerLaw {
    /// Initial stiffness K_T.
    pub stiffness: f64,
    /// Coefficient R / ((χ+1)(χ+2)) of the softening term.
    pub coefficient: f64,
    /// Exponent χ + 2 of the softening term.
    pub exponent: f64,
    /// Displacement φ_max up to which the form holds.
    pub limit: f64,
}

/// A backbone (virgin loading) curve and the quantities that follow from it.
///
/// All functions take a joint displacement `u` of either sign in the user's
/// length unit. Odd: [`force`](Self::force). Even: all others.
pub trait Backbone {
    /// Stiffness K_T at zero displacement (all sliders stick), > 0.
    fn initial_stiffness(&self) -> f64;

    /// Force F_S > 0 at which all sliders slip. Where friction drops once sliders slip, F_S is the sum of the static limits.
    fn slip_force(&self) -> f64;

    /// Ratio θ of dynamic to static friction of the sliders, 0 < θ <= 1. For θ = 1 loops follow the virgin curve by Masing's rule. For θ <
    /// 1 they do not, and functions that rest on Masing's rule refuse the law.
    fn friction_ratio(&self) -> f64 {
        1.0
    }

    /// Strengths of the weakest and of the strongest slider: no slip below the first
    /// displacement, macro-slip above the second.
    fn strengths(&self) -> (f64, f64);

    /// Force F(u) on the virgin curve.
    fn force(&self, u: f64) -> f64;

    /// Tangent stiffness K(u) = dF/du: 0 at and beyond macro-slip.
    fn tangent(&self, u: f64) -> f64;

    /// Work G(u) = ∫ F du from 0 to u.
    fn energy(&self, u: f64) -> f64;

    /// Energy D(u) dissipated in one closed cycle between -u and u.
    ///
    /// Masing's rule gives D = 8 G(u) - 4 u F(u); laws with a closed form override
    /// this, because the difference loses digits at small u.
    fn dissipation(&self, u: f64) -> f64 {
        let u = u.abs();
        8.0 * self.energy(u) - 4.0 * u * self.force(u)
    }

    /// Energy stored in the sliders' springs at a turning point of the closed cycle between -u and u: by Masing's rule G(u) - D(u)/4.
    fn energy_at_turn(&self, u: f64) -> f64 {
        let u = u.abs();
        self.energy(u) - 0.25 * self.dissipation(u)
    }

    /// Secant stiffness F(u)/u, K_T at u = 0.
    fn secant(&self, u: f64) -> f64 {
        if u == 0.0 { self.initial_stiffness() } else { self.force(u) / u }
    }

    /// First-harmonic (harmonic-balance) stiffness K_1(u) = (1/πu) ∮ F cos θ dθ over a closed
    /// cycle of amplitude u, K_T at u = 0.
    ///
    /// With Masing's rule K_1 = -(4/πu) ∫ F(u sin²(θ/2)) cos θ dθ from 0 to π. The parts of the integral below the weakest and beyond the
    /// strongest slider are taken in closed form.
    fn harmonic_stiffness(&self, u: f64) -> f64 {
        first_harmonic(self, u.abs())
    }

    /// First-harmonic stiffness K_1 and dissipation D of a cycle of amplitude u in one call. Laws whose two formulas contain the same power
    /// override this default.
    #[inline]
    fn stiffness_and_dissipation(&self, u: f64) -> (f64, f64) {
        (self.harmonic_stiffness(u), self.dissipation(u))
    }

    /// Force F(u) and tangent K(u) in one call. Laws whose two formulas contain the same power override this default.
    #[inline]
    fn force_and_tangent(&self, u: f64) -> (f64, f64) {
        (self.force(u), self.tangent(u))
    }

    /// Total stiffness ∫ ρ of the sliders of strength < φ, for φ >= 0.
    fn stiffness_below(&self, phi: f64) -> f64;

    /// Total slip force ∫ ρ φ of the sliders of strength < φ, for φ >= 0.
    fn force_below(&self, phi: f64) -> f64;

    /// Whether the tangent K(u) is smooth between the strengths of the weakest and the strongest slider.
    fn is_smooth(&self) -> bool;

    /// The parameters of the micro-slip power law, if the law has that form: with them the half-cycle map computes one power for a whole
    /// half cycle.
    fn power_law(&self) -> Option<PowerLaw> {
        None
    }
}

/// Refuses a law that does not obey Masing's rule.
pub(crate) fn check_masing<B: Backbone + ?Sized>(law: &B) -> Result<(), Error> {
    if law.friction_ratio() == 1.0 {
        return Ok(());
    }
    let what = "a joint with dynamic below static friction does not follow Masing's rule, on which this rests: step it on \
        sliders by Newmark's method (beta = 0.25, gamma = 0.5), or average it";
    Err(Error::Unsupported { what })
}

/// Panels of 16 nodes each in the first-harmonic quadrature, between the corners at the weakest and the strongest slider. A smooth density
/// needs two panels (one leaves an error of 3e-12 at χ = -0.95); more panels change only the rounding. The other two panels are for the
/// corners of a tabulated density, which lie within the panels: for a table of four points, one, two, four and eight panels leave errors of
/// 2e-5, 3e-6, 2e-7 and 3e-9.
const PANELS: u32 = 4;

/// [`Backbone::harmonic_stiffness`] of any law by quadrature, for `u` > 0.
pub(crate) fn first_harmonic<B: Backbone + ?Sized>(law: &B, u: f64) -> f64 {
    const RULE: Rule<16> = Rule::gauss_legendre();
    let (weakest, strongest) = law.strengths();
    if u <= weakest {
        return law.initial_stiffness();
    }
    let angle = |z: f64| 2.0 * libm::asin(libm::sqrt((z / u).min(1.0)));
    let (first, last) = (angle(weakest), angle(strongest));
    let integrand = |theta: f64| {
        let half = libm::sin(0.5 * theta);
        law.force(u * half * half) * libm::cos(theta)
    };
    // Below the weakest strength F = K_T z, so that with z = u sin²(θ/2) the integral is elementary.
    let stuck =
        0.5 * law.initial_stiffness() * u * (libm::sin(first) - 0.5 * (first + 0.5 * libm::sin(2.0 * first)));
    // θ = first + (last - first) s²: flattens the u^(χ+2) corner at the start.
    let span = last - first;
    let width = 1.0 / f64::from(PANELS);
    let slipping: f64 = (0..PANELS)
        .map(|i| {
            let from = f64::from(i) * width;
            RULE.integrate(from, from + width, |s| 2.0 * s * span * integrand(first + span * s * s))
        })
        .sum();
    // Without macro-slip the term is set to 0: rounded, sin π is not 0, and F_S times that rounding would exceed the whole integral of a
    // small cycle.
    let sliding = if u > strongest { -law.slip_force() * libm::sin(last) } else { 0.0 };
    -4.0 / (core::f64::consts::PI * u) * (stuck + slipping + sliding)
}

impl<B: Backbone + ?Sized> Backbone for &B {
    fn initial_stiffness(&self) -> f64 {
        (**self).initial_stiffness()
    }
    fn slip_force(&self) -> f64 {
        (**self).slip_force()
    }
    fn friction_ratio(&self) -> f64 {
        (**self).friction_ratio()
    }
    fn strengths(&self) -> (f64, f64) {
        (**self).strengths()
    }
    fn force(&self, u: f64) -> f64 {
        (**self).force(u)
    }
    fn tangent(&self, u: f64) -> f64 {
        (**self).tangent(u)
    }
    fn energy(&self, u: f64) -> f64 {
        (**self).energy(u)
    }
    fn dissipation(&self, u: f64) -> f64 {
        (**self).dissipation(u)
    }
    fn energy_at_turn(&self, u: f64) -> f64 {
        (**self).energy_at_turn(u)
    }
    fn harmonic_stiffness(&self, u: f64) -> f64 {
        (**self).harmonic_stiffness(u)
    }
    fn stiffness_and_dissipation(&self, u: f64) -> (f64, f64) {
        (**self).stiffness_and_dissipation(u)
    }
    fn force_and_tangent(&self, u: f64) -> (f64, f64) {
        (**self).force_and_tangent(u)
    }
    fn stiffness_below(&self, phi: f64) -> f64 {
        (**self).stiffness_below(phi)
    }
    fn force_below(&self, phi: f64) -> f64 {
        (**self).force_below(phi)
    }
    fn is_smooth(&self) -> bool {
        (**self).is_smooth()
    }
    fn power_law(&self) -> Option<PowerLaw> {
        (**self).power_law()
    }
}
