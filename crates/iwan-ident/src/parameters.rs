//! The parameters of a modal Iwan oscillator.

use iwan_core::{FourParameter, Oscillator, ResidualStiffness};
use serde::{Deserialize, Serialize};

use crate::error::Error;

/// Number of parameters.
pub(crate) const COUNT: usize = 6;

/// One mode with a four-parameter Iwan joint and a viscous damper in parallel (Eq. 5).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Parameters {
    /// Small-amplitude frequency ω0/2π, Hz.
    pub frequency: f64,
    /// Viscous damping ratio ζ_v.
    pub damping_ratio: f64,
    /// Joint stiffness K_T, 1/s² (mass-normalised), below ω0².
    pub k_t: f64,
    /// Slip force F_S, mass-normalised.
    pub f_s: f64,
    /// Power χ, -1 < χ < 1.
    pub chi: f64,
    /// Ratio β.
    pub beta: f64,
}

/// One of the six parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Parameter {
    /// Small-amplitude frequency.
    Frequency,
    /// Viscous damping ratio.
    DampingRatio,
    /// Joint stiffness.
    KT,
    /// Slip force.
    FS,
    /// Power of the density.
    Chi,
    /// Ratio of the Dirac to the power-law part.
    Beta,
}

impl Parameter {
    /// All six, in the order of the coordinates.
    pub const ALL: [Self; COUNT] =
        [Self::Frequency, Self::DampingRatio, Self::KT, Self::FS, Self::Chi, Self::Beta];

    /// Name in results: `frequency`, `damping_ratio`, `k_t`, `f_s`, `chi`, `beta`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Frequency => "frequency",
            Self::DampingRatio => "damping_ratio",
            Self::KT => "k_t",
            Self::FS => "f_s",
            Self::Chi => "chi",
            Self::Beta => "beta",
        }
    }
}

impl Parameters {
    /// One of them by name.
    #[must_use]
    pub const fn get(&self, parameter: Parameter) -> f64 {
        match parameter {
            Parameter::Frequency => self.frequency,
            Parameter::DampingRatio => self.damping_ratio,
            Parameter::KT => self.k_t,
            Parameter::FS => self.f_s,
            Parameter::Chi => self.chi,
            Parameter::Beta => self.beta,
        }
    }

    /// One of them by name, to be changed.
    pub const fn get_mut(&mut self, parameter: Parameter) -> &mut f64 {
        match parameter {
            Parameter::Frequency => &mut self.frequency,
            Parameter::DampingRatio => &mut self.damping_ratio,
            Parameter::KT => &mut self.k_t,
            Parameter::FS => &mut self.f_s,
            Parameter::Chi => &mut self.chi,
            Parameter::Beta => &mut self.beta,
        }
    }

    /// The joint and the oscillator that holds it.
    ///
    /// # Errors
    /// [`Error::Model`] when a value is out of range.
    ///
    /// ```
    /// use iwan_ident::Parameters;
    /// let mode = Parameters { frequency: 124.0, damping_ratio: 0.0, k_t: 4.45e4, f_s: 239.4, chi: -0.183, beta: 0.3 };
    /// let (oscillator, joint) = mode.model()?;
    /// assert!((joint.phi_max() - 0.009329393723670242).abs() < 1e-15);
    /// assert!(oscillator.k_inf() > 0.0);
    /// # Ok::<(), iwan_ident::Error>(())
    /// ```
    pub fn model(&self) -> Result<(Oscillator, FourParameter), Error> {
        let joint = FourParameter::new(self.k_t, self.f_s, self.chi, self.beta)?;
        let positive = ResidualStiffness::Positive;
        Ok((Oscillator::new(self.frequency, self.damping_ratio, self.k_t, positive)?, joint))
    }
}
