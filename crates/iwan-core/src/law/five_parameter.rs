//! The Iwan joint with five parameters {K_T, F_S, χ, β, θ}: Segalman's four-parameter joint with dynamic friction below static friction.
//!
//! Source: M. P. Mignolet, P. Song and X. Q. Wang, A stochastic Iwan-type model for joint behavior variability modeling, J. Sound Vib.
//! 349:289, 2015, doi:10.1016/j.jsv.2015.03.032, where each Jenkins element slides at a part θ of the force that breaks it loose. With
//! Segalman's density (doi:10.1115/1.1989354) the virgin curve is the one that M. R. W. Brake uses (A reduced Iwan model that includes
//! pinning for bolted joint mechanics, Nonlinear Dyn. 87:1335, 2017, doi:10.1007/s11071-016-3117-2). Masing's rule does not hold, so the
//! cycles are derived here slider by slider.

use core::f64::consts::PI;

use super::backbone::{Backbone, PowerLaw};
use super::breakaway::Breakaway;
use super::cosine_moment::{cosine_moment, linear_moment};
use super::four_parameter::FourParameter;
use crate::error::{Error, check};

/// An Iwan joint of five parameters: a [`FourParameter`] joint whose sliders, once loose, rub with the part θ of the force that broke them
/// loose, until the motion turns round and they stick again.
///
/// Its cycles depend on the earlier motion. From rest a slider breaks loose where the displacement reaches its strength φ; a slider that
/// already slides goes on sliding down to the amplitude (1+θ)φ/2. So a cycle reached from smaller amplitudes dissipates less than the same
/// cycle within a decay. A newly made joint is virgin: its [`dissipation`](Backbone::dissipation),
/// [`harmonic_stiffness`](Backbone::harmonic_stiffness) and [`energy_at_turn`](Backbone::energy_at_turn) are those of cycles reached from
/// rest; [`after`](Self::after) gives those of a decay.
///
/// ```
/// use iwan_core::{Backbone, FiveParameter};
/// let joint = FiveParameter::new(2.75e5, 300.0, -0.3, 0.02, 0.8)?;
/// let u = 0.5 * joint.phi_max();
/// // Beyond φ_max all sliders slide, at 0.8 of their strength.
/// assert!((joint.force(2.0 * joint.phi_max()) - 240.0).abs() < 1e-12);
/// // A decay passes this amplitude with more sliders in motion.
/// assert!(joint.after(f64::INFINITY).dissipation(u) > joint.dissipation(u));
/// # Ok::<(), iwan_core::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FiveParameter {
    /// The four-parameter joint of the static limits.
    sticking: FourParameter,
    breakaway: Breakaway,
    /// Largest amplitude of the motion so far.
    largest: f64,
}

/// Stiffness, slip force and ∫ρφ² of the power-law sliders up to a strength.
#[derive(Clone, Copy)]
struct Below {
    strength: f64,
    stiffness: f64,
    force: f64,
    square: f64,
}

impl FiveParameter {
    /// From stiffness `k_t`, static slip force `f_s`, power `chi` and `beta` as in [`FourParameter::new`], and the ratio
    /// 0 < `theta` <= 1 of dynamic to static friction.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with the parameter's name.
    pub fn new(k_t: f64, f_s: f64, chi: f64, beta: f64, theta: f64) -> Result<Self, Error> {
        Self::dropping(FourParameter::new(k_t, f_s, chi, beta)?, theta)
    }

    /// A four-parameter joint whose friction drops to the part 0 < `theta` <= 1 once it slips.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for `theta`.
    pub fn dropping(sticking: FourParameter, theta: f64) -> Result<Self, Error> {
        check("theta", theta, theta > 0.0 && theta <= 1.0, "must satisfy 0 < theta <= 1")?;
        Ok(Self { sticking, breakaway: Breakaway { ratio: theta }, largest: 0.0 })
    }

    /// The same joint after motions of amplitudes up to `largest` (length; infinite for a decay from any amplitude). Its cycles are then
    /// those that a decay from `largest` passes through.
    #[must_use]
    pub fn after(self, largest: f64) -> Self {
        Self { largest: largest.abs(), ..self }
    }

    /// The four-parameter joint of the static friction, with K_T, F_S, χ, β and the density.
    #[must_use]
    pub const fn sticking(&self) -> &FourParameter {
        &self.sticking
    }

    /// Ratio θ of dynamic to static friction.
    #[must_use]
    pub const fn theta(&self) -> f64 {
        self.breakaway.ratio
    }

    /// Displacement φ_max at which the last slider breaks loose from rest; the joint's force drops there.
    #[must_use]
    pub const fn phi_max(&self) -> f64 {
        self.sticking.phi_max()
    }

    /// Factor 1 + (1-θ)(χ+1) by which the virgin curve softens more than that of the four-parameter joint.
    fn softening(&self) -> f64 {
        1.0 + (1.0 - self.theta()) * (self.sticking.chi() + 1.0)
    }

    fn below(&self, strength: f64) -> Below {
        let (c, phi) = (self.sticking.chi(), strength.min(self.phi_max()));
        let stiffness = self.sticking.k_power * self.sticking.power(phi);
        let force = stiffness * (c + 1.0) / (c + 2.0) * phi;
        let square = stiffness * (c + 1.0) / (c + 3.0) * phi * phi;
        Below { strength: phi, stiffness, force, square }
    }

    /// The sliders that slide in a cycle of amplitude `u` >= 0: moments of those of the power law, and whether the Dirac slider slides.
    fn sliding(&self, u: f64) -> (Below, bool) {
        let reach = self.breakaway.reach(u, self.largest);
        (self.below(reach), reach >= self.phi_max())
    }

    /// First-harmonic stiffness of the sliders of the power law that slide in a cycle of amplitude `u` > 0.
    ///
    /// On the way z from a turning point the force of these sliders falls by K z - C z^(χ+2), with C = R (1+θ)^-(χ+1) [1/(χ+1) -
    /// 2θ/((1+θ)(χ+2))], up to z = (1+θ)φ of the strongest slider, where all slide; beyond, the force is constant. K_1 is -(2/πu) times the
    /// integral of this fall over cos ψ dψ, with z = u (1 - cos ψ).
    fn harmonic_of(&self, all: Below, u: f64) -> f64 {
        let (theta, p) = (self.theta(), self.sticking.chi() + 2.0);
        let x = (0.5 * (1.0 + theta) * all.strength / u).min(1.0);
        let linear = (1.0 + theta) * all.strength * all.stiffness;
        let sliding = 2.0 * theta * all.force;
        let softening = linear - sliding;
        let moments =
            linear * linear_moment(x) - softening * cosine_moment(p, self.sticking.complete_beta(), x);
        -2.0 / (PI * u) * (moments - 2.0 * sliding * libm::sqrt(x * (1.0 - x)))
    }
}

impl Backbone for FiveParameter {
    fn initial_stiffness(&self) -> f64 {
        self.sticking.k_t()
    }

    fn slip_force(&self) -> f64 {
        self.sticking.f_s()
    }

    fn friction_ratio(&self) -> f64 {
        self.theta()
    }

    fn strengths(&self) -> (f64, f64) {
        self.sticking.strengths()
    }

    /// F = K_T u - R u^(χ+2) [1 + (1-θ)(χ+1)] / ((χ+1)(χ+2)) up to φ_max, where it drops to θ F_S.
    fn force(&self, u: f64) -> f64 {
        let law = &self.sticking;
        if law.slipping(u) {
            return (self.theta() * law.f_s()).copysign(u);
        }
        u * (law.k_t() - law.k_power / (law.chi() + 2.0) * law.power(u) * self.softening())
    }

    /// K = K_T - R u^(χ+1) [1 + (1-θ)(χ+1)] / (χ+1) up to φ_max, where it may be negative; 0 beyond.
    fn tangent(&self, u: f64) -> f64 {
        let law = &self.sticking;
        if law.slipping(u) { 0.0 } else { law.k_t() - law.k_power * law.power(u) * self.softening() }
    }

    fn energy(&self, u: f64) -> f64 {
        let law = &self.sticking;
        let stuck = u.abs().min(law.phi_max());
        let power = law.k_power * law.power(stuck) * self.softening();
        let micro = stuck * stuck * (0.5 * law.k_t() - power / ((law.chi() + 2.0) * (law.chi() + 3.0)));
        micro + self.theta() * law.f_s() * (u.abs() - stuck)
    }

    /// D = 4θ u ∫ρφ + (1+θ)(1-3θ) ∫ρφ² over the sliders that slide.
    fn dissipation(&self, u: f64) -> f64 {
        let u = u.abs();
        let (below, all) = self.sliding(u);
        let power = 4.0 * self.theta() * u * below.force + self.breakaway.broken() * below.square;
        if all { power + self.sticking.s() * self.breakaway.dissipation(self.phi_max(), u) } else { power }
    }

    /// Sum of three energies: ½θ² ∫ρφ² of the sliders that slide, ½ K u² of those that stick, and the energy left in the springs of those
    /// that slid before and stick now.
    fn energy_at_turn(&self, u: f64) -> f64 {
        let (u, law) = (u.abs(), &self.sticking);
        let (below, all) = self.sliding(u);
        let dirac = law.s() * self.phi_max() * self.phi_max();
        let sliding = below.square + if all { dirac } else { 0.0 };
        let stuck = if all { 0.0 } else { law.k_t() - below.stiffness };
        let slid = self.below(self.largest.max(below.strength));
        let left =
            slid.square - below.square + if !all && self.largest >= self.phi_max() { dirac } else { 0.0 };
        let left_over = self.breakaway.left_over();
        0.5 * (self.theta() * self.theta() * sliding + stuck * u * u + left_over * left_over * left)
    }

    fn harmonic_stiffness(&self, u: f64) -> f64 {
        let (u, law) = (u.abs(), &self.sticking);
        let (below, all) = self.sliding(u);
        if below.strength == 0.0 || u == 0.0 {
            return law.k_t();
        }
        let others = if all {
            law.s() * self.breakaway.harmonic(self.phi_max(), u)
        } else {
            law.k_t() - below.stiffness
        };
        others + self.harmonic_of(below, u)
    }

    fn is_smooth(&self) -> bool {
        true
    }

    fn stiffness_below(&self, phi: f64) -> f64 {
        self.sticking.stiffness_below(phi)
    }

    fn force_below(&self, phi: f64) -> f64 {
        self.sticking.force_below(phi)
    }

    fn power_law(&self) -> Option<PowerLaw> {
        if self.theta() == 1.0 { self.sticking.power_law() } else { None }
    }
}
