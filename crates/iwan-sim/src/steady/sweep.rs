//! The request for a steady forced response: the band of frequencies, the quantity that is held, and its levels.

use iwan_core::Error;

use crate::error::SimulationError;

/// The quantity that a shaker's control holds while the frequency changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Control {
    /// The amplitude of the force.
    Force,
    /// The amplitude of the acceleration of the base on which the structure stands; the response is relative to the base.
    BaseAcceleration,
    /// The amplitude of the response as displacement; controllers track its first harmonic.
    Displacement,
    /// The amplitude of the response as velocity.
    Velocity,
    /// The amplitude of the response as acceleration.
    Acceleration,
}

impl Control {
    /// Whether the response is held, so that the force follows from the response.
    #[must_use]
    pub const fn holds_response(self) -> bool {
        matches!(self, Self::Displacement | Self::Velocity | Self::Acceleration)
    }

    /// Name in scenarios and tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Force => "force",
            Self::BaseAcceleration => "base_acceleration",
            Self::Displacement => "displacement",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
        }
    }

    /// Displacement amplitude of a response at the given `level` and circular frequency `omega` (rad/s).
    pub(crate) fn displacement(self, level: f64, omega: f64) -> f64 {
        match self {
            Self::Velocity => level / omega,
            Self::Acceleration => level / (omega * omega),
            _ => level,
        }
    }
}

/// A request for steady forced responses over a band of frequencies.
#[derive(Debug, Clone, PartialEq)]
pub struct Sweep {
    /// Lower end of the band, Hz, > 0.
    pub from: f64,
    /// Upper end of the band, Hz.
    pub to: f64,
    /// The quantity whose amplitude is held.
    pub control: Control,
    /// Amplitudes at which it is held, each > 0.
    pub levels: Vec<f64>,
    /// The highest harmonic of the response, an odd number; 1 is harmonic balance with the fundamental alone.
    pub harmonics: usize,
    /// Approximate number of points per level; at least [`Sweep::LEAST_POINTS`].
    pub points: usize,
}

impl Sweep {
    /// Smallest number of points per level: with fewer the two sides of a resonance look angular.
    pub const LEAST_POINTS: usize = 16;

    /// Largest number of points per level: a thousand times what a picture shows. They take 0.3 s and 100 MB per level.
    pub const MOST_POINTS: usize = 1_000_000;

    /// Default number of points per level: a resonance looks smooth at any width of a page.
    pub const DEFAULT_POINTS: usize = 400;

    /// Checks band, levels and harmonics.
    ///
    /// # Errors
    /// [`SimulationError::Parameter`] with the name of the quantity.
    pub fn checked(&self) -> Result<(), SimulationError> {
        let refuse = |name, value, allowed| Err(Error::OutOfRange { name, value, allowed }.into());
        if !(self.from > 0.0 && self.from.is_finite()) {
            return refuse("from", self.from, "must be a finite number of hertz > 0");
        }
        if !(self.to > self.from && self.to.is_finite()) {
            return refuse("to", self.to, "must be a finite number of hertz above `from`");
        }
        if let Some(&level) = self.levels.iter().find(|level| !(**level > 0.0 && level.is_finite())) {
            return refuse("level", level, "must be a finite number > 0: at 0 nothing moves");
        }
        if self.levels.is_empty() {
            return Err(Error::Length { name: "levels", needed: 1, found: 0 }.into());
        }
        if !(Self::LEAST_POINTS..=Self::MOST_POINTS).contains(&self.points) {
            return refuse("points", self.points as f64, "must be 16 to 1,000,000");
        }
        iwan_core::Harmonics::odd(self.harmonics)?;
        Ok(())
    }
}
