//! A density of sliders of any form, and what it says about the four-parameter form.

use std::f64::consts::{PI, TAU};

use iwan_core::{Backbone, DensityPoint, Oscillator, ResidualStiffness, Tabulated};

use crate::curve_fit::{Predicted, Verdict};
use crate::error::Error;

/// Mean squared residual, in units of the curves' variance, up to which the curves count as explained: 1 is expected, and the standard deviations of
/// smooth curves are themselves known to a factor of √2 or so.
const EXPLAINED: f64 = 2.0;

/// The curves that the density shall match.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Evidence {
    /// Dissipation and frequency, each by its standard deviation.
    #[default]
    Both,
    /// Dissipation alone, which determines the density by itself: D'' = 4 u ρ(u). The frequency that this density predicts shows whether sliders
    /// explain both curves. Only ω0 is taken from the frequency.
    Dissipation,
}

/// A density of any form, and how well it matches the curves.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeForm {
    /// Strengths φ of the points, ascending, in the unit of displacement.
    pub strength: Vec<f64>,
    /// Density ρ >= 0 at the points, linear in between, in stiffness per displacement.
    pub density: Vec<f64>,
    /// Small-amplitude frequency, Hz: an extrapolation to amplitudes at which the weakest sliders stick.
    pub frequency: f64,
    /// Viscous damping ratio.
    pub damping_ratio: f64,
    /// Smallest and largest amplitude seen. Sliders stronger than the largest amplitude never slipped: their stiffness is part of K_∞. Of sliders
    /// weaker than the smallest amplitude only the sum of their slip forces is known.
    pub informed: (f64, f64),
    /// Mean squared residual in standard deviations of the curves, which are at least as large as what averaging neglects: 1 where the density
    /// explains the curves.
    pub mean_square: f64,
    /// Root-mean-square misfit of ln D (D: dissipation per cycle).
    pub dissipation_misfit: f64,
    /// Root-mean-square misfit of the frequency, Hz.
    pub frequency_misfit: f64,
    /// The curves that the density was to match.
    pub evidence: Evidence,
    /// Weight of the regularisation relative to the curves.
    pub regularisation: f64,
}

impl FreeForm {
    /// Density at a strength: linear between the points, 0 outside.
    #[must_use]
    pub fn at(&self, strength: f64) -> f64 {
        let next = self.strength.partition_point(|s| *s <= strength);
        match next {
            0 => 0.0,
            n if n == self.strength.len() => {
                if strength == self.strength[n - 1] {
                    self.density[n - 1]
                } else {
                    0.0
                }
            }
            n => {
                let (a, b) = (self.strength[n - 1], self.strength[n]);
                self.density[n - 1] + (strength - a) / (b - a) * (self.density[n] - self.density[n - 1])
            }
        }
    }

    /// The joint that has this density: a law of iwan-core that every stepper runs, as a continuum or cut into sliders.
    ///
    /// # Errors
    /// [`Error::Model`] when the whole density is zero: the record needs no joint.
    pub fn law(&self) -> Result<Tabulated<Vec<DensityPoint>>, Error> {
        let points = vec![DensityPoint::default(); self.strength.len()];
        Ok(Tabulated::new(&self.strength, &self.density, 0.0, points)?)
    }

    /// The oscillator, and the joint that it holds.
    ///
    /// # Errors
    /// [`Error::Model`] when the density is zero or takes more stiffness than ω0².
    pub fn model(&self) -> Result<(Oscillator, Tabulated<Vec<DensityPoint>>), Error> {
        let law = self.law()?;
        let k_t = law.initial_stiffness();
        let positive = ResidualStiffness::Positive;
        Ok((Oscillator::new(self.frequency, self.damping_ratio, k_t, positive)?, law))
    }

    /// Dissipation per cycle and frequency at a displacement amplitude, as in [`predict`](crate::curve_fit::predict).
    ///
    /// # Errors
    /// As [`model`](Self::model).
    pub fn predict(&self, displacement: f64) -> Result<Predicted, Error> {
        let (oscillator, law) = self.model()?;
        let omega = (oscillator.k_inf() + law.harmonic_stiffness(displacement)).sqrt();
        let viscous = PI * oscillator.viscous() * omega * displacement * displacement;
        Ok(Predicted { dissipation: law.dissipation(displacement) + viscous, frequency: omega / TAU })
    }

    /// What the free form says about the four-parameter form `four`, in words and numbers.
    #[must_use]
    pub fn words(&self, four: &Verdict) -> String {
        let explains = self.mean_square < EXPLAINED;
        let verdict = match (self.evidence, explains) {
            (Evidence::Both, true) if four.adequate => "both forms match",
            (Evidence::Both, true) => {
                "a density of another form matches where the four-parameter one does not"
            }
            (Evidence::Both, false) if four.adequate => {
                "no density comes nearer: what is left over is not the form of the density"
            }
            (Evidence::Both, false) => {
                "no density of sliders matches dissipation and frequency together: what is missed is not the form of the \
                 density, but something that is no Iwan joint with a viscous damper"
            }
            (Evidence::Dissipation, _) => "this is the frequency that the dissipation asks for",
        };
        let what =
            if self.evidence == Evidence::Both { "to both curves" } else { "to the dissipation alone" };
        format!(
            "free-form density {what}: dissipation is missed by {:.2} % (four parameters fitted to the same curves: \
             {:.2} %), frequency by {:.4} Hz ({:.4} Hz); strengths from {:.4e} to {:.4e} are informed by the record: {verdict}",
            100.0 * self.dissipation_misfit,
            100.0 * four.dissipation_misfit,
            self.frequency_misfit,
            four.frequency_misfit,
            self.informed.0,
            self.informed.1
        )
    }
}
