//! The joint laws that a mode can have, as one type.

use iwan_core::{
    Backbone, DensityPoint, Error, FiveParameter, FourParameter, Jenkins, PowerLaw, Tabulated, Uniform,
};

/// A tabulated density that owns its points.
pub type TabulatedDensity = Tabulated<Vec<DensityPoint>>;

/// Any of the shipped joint laws.
#[derive(Debug, Clone, PartialEq)]
pub enum JointLaw {
    /// Segalman's four-parameter Iwan joint.
    FourParameter(FourParameter),
    /// Segalman's joint with dynamic friction below static friction.
    FiveParameter(FiveParameter),
    /// One Jenkins element.
    Jenkins(Jenkins),
    /// Iwan's 1966 model: strengths uniform over a band.
    Uniform(Uniform),
    /// A density given point by point.
    Tabulated(TabulatedDensity),
}

/// Runs `$body` with `$law` bound to the concrete law, so that inner loops are compiled for it.
macro_rules! with_law {
    ($joint:expr, $law:ident => $body:expr) => {
        match $joint {
            $crate::joint_law::JointLaw::FourParameter($law) => $body,
            $crate::joint_law::JointLaw::FiveParameter($law) => $body,
            $crate::joint_law::JointLaw::Jenkins($law) => $body,
            $crate::joint_law::JointLaw::Uniform($law) => $body,
            $crate::joint_law::JointLaw::Tabulated($law) => $body,
        }
    };
}
pub(crate) use with_law;

impl JointLaw {
    /// A law from a density: ρ_i (stiffness/length) at the strengths φ_i (length), linear in between, and the stiffness `dirac` of a slider
    /// at the last strength.
    ///
    /// # Errors
    /// As [`Tabulated::new`].
    pub fn tabulated(strength: &[f64], density: &[f64], dirac: f64) -> Result<Self, Error> {
        let points = vec![DensityPoint::default(); strength.len()];
        Tabulated::new(strength, density, dirac, points).map(Self::Tabulated)
    }

    /// The law whose cycles are those after motions of amplitudes up to `largest` (length). It differs from `self` only where friction
    /// drops once a slider slips ([`FiveParameter::after`]).
    #[must_use]
    pub fn after(&self, largest: f64) -> Self {
        match self {
            Self::FiveParameter(law) => Self::FiveParameter(law.after(largest)),
            law => law.clone(),
        }
    }

    /// Density ρ(φ) of the sliders at the strength φ (stiffness/length). Sliders that all have one strength are not part of it: see
    /// [`dirac`](Self::dirac).
    #[must_use]
    pub fn density(&self, phi: f64) -> f64 {
        match self {
            Self::FourParameter(law) => law.density(phi),
            Self::FiveParameter(law) => law.sticking().density(phi),
            Self::Jenkins(_) => 0.0,
            Self::Uniform(law) => law.density(phi),
            Self::Tabulated(law) => law.density(phi),
        }
    }

    /// Stiffness of the sliders that all have the largest strength.
    #[must_use]
    pub fn dirac(&self) -> f64 {
        match self {
            Self::FourParameter(law) => law.s(),
            Self::FiveParameter(law) => law.sticking().s(),
            Self::Jenkins(law) => law.initial_stiffness(),
            Self::Uniform(_) => 0.0,
            Self::Tabulated(law) => law.dirac(),
        }
    }
}

impl Backbone for JointLaw {
    fn initial_stiffness(&self) -> f64 {
        with_law!(self, law => law.initial_stiffness())
    }
    fn slip_force(&self) -> f64 {
        with_law!(self, law => law.slip_force())
    }
    fn strengths(&self) -> (f64, f64) {
        with_law!(self, law => law.strengths())
    }
    fn friction_ratio(&self) -> f64 {
        with_law!(self, law => law.friction_ratio())
    }
    fn force(&self, u: f64) -> f64 {
        with_law!(self, law => law.force(u))
    }
    fn tangent(&self, u: f64) -> f64 {
        with_law!(self, law => law.tangent(u))
    }
    fn energy(&self, u: f64) -> f64 {
        with_law!(self, law => law.energy(u))
    }
    fn dissipation(&self, u: f64) -> f64 {
        with_law!(self, law => law.dissipation(u))
    }
    fn energy_at_turn(&self, u: f64) -> f64 {
        with_law!(self, law => law.energy_at_turn(u))
    }
    fn harmonic_stiffness(&self, u: f64) -> f64 {
        with_law!(self, law => law.harmonic_stiffness(u))
    }
    fn stiffness_and_dissipation(&self, u: f64) -> (f64, f64) {
        with_law!(self, law => law.stiffness_and_dissipation(u))
    }
    fn force_and_tangent(&self, u: f64) -> (f64, f64) {
        with_law!(self, law => law.force_and_tangent(u))
    }
    fn stiffness_below(&self, phi: f64) -> f64 {
        with_law!(self, law => law.stiffness_below(phi))
    }
    fn force_below(&self, phi: f64) -> f64 {
        with_law!(self, law => law.force_below(phi))
    }
    fn is_smooth(&self) -> bool {
        with_law!(self, law => law.is_smooth())
    }
    fn power_law(&self) -> Option<PowerLaw> {
        with_law!(self, law => law.power_law())
    }
}

#[cfg(test)]
mod tests {
    use iwan_core::quadrature::Rule;

    use super::*;

    /// ∫ρ up to a strength is the stiffness of the sliders below it; with the Dirac it is K_T.
    #[test]
    fn the_density_integrates_to_the_stiffness() {
        const RULE: Rule<16> = Rule::gauss_legendre();
        let laws = [
            JointLaw::FourParameter(FourParameter::new(4.45e4, 239.4, -0.183, 0.3).unwrap()),
            JointLaw::FiveParameter(FiveParameter::new(4.45e4, 239.4, -0.183, 0.3, 0.7).unwrap()),
            JointLaw::Uniform(Uniform::new(1e3, 5.0, 0.4).unwrap()),
            JointLaw::tabulated(&[0.0, 0.002, 0.01], &[1e5, 3e5, 2e5], 70.0).unwrap(),
            JointLaw::Jenkins(Jenkins::new(1e3, 5.0).unwrap()),
        ];
        for law in laws {
            let (low, high) = law.strengths();
            // φ = low + (high - low) s^4 flattens the corner at 0; panels lie between the kinks of the table.
            let integrand =
                |s: f64| 4.0 * s.powi(3) * (high - low) * law.density(low + (high - low) * s.powi(4));
            let kink = 0.2_f64.powf(0.25);
            let below = RULE.integrate(0.0, kink, integrand) + RULE.integrate(kink, 1.0, integrand);
            assert!(
                (below + law.dirac() - law.initial_stiffness()).abs() < 1e-6 * law.initial_stiffness(),
                "{law:?}"
            );
            assert_eq!(law.density(-1e-9) + law.density(1.001 * high), 0.0, "{law:?}");
        }
    }
}
