//! The joint laws a mode can carry, behind one type.

use iwan_core::{Backbone, DensityPoint, Error, FourParameter, Jenkins, PowerLaw, Tabulated, Uniform};

/// A tabulated density that owns its points.
pub type TabulatedDensity = Tabulated<Vec<DensityPoint>>;

/// Any of the shipped joint laws.
#[derive(Debug, Clone, PartialEq)]
pub enum JointLaw {
    /// Segalman's four-parameter Iwan joint.
    FourParameter(FourParameter),
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
            $crate::JointLaw::FourParameter($law) => $body,
            $crate::JointLaw::Jenkins($law) => $body,
            $crate::JointLaw::Uniform($law) => $body,
            $crate::JointLaw::Tabulated($law) => $body,
        }
    };
}
pub(crate) use with_law;

impl JointLaw {
    /// A density ρ_i (stiffness/length) at the strengths φ_i (length), linear in between, and the
    /// stiffness of a slider at the last strength.
    ///
    /// # Errors
    /// As [`Tabulated::new`].
    pub fn tabulated(strength: &[f64], density: &[f64], dirac: f64) -> Result<Self, Error> {
        let points = vec![DensityPoint::default(); strength.len()];
        Tabulated::new(strength, density, dirac, points).map(Self::Tabulated)
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
    fn harmonic_stiffness(&self, u: f64) -> f64 {
        with_law!(self, law => law.harmonic_stiffness(u))
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
