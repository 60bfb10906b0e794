//! What a steady forced response is asked for: a band of frequencies, what is held, at which levels.

use iwan_core::Error;

use crate::error::SimulationError;

/// What the control of a shaker holds while the frequency changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Control {
    /// The amplitude of the force.
    Force,
    /// The amplitude of the acceleration of the base on which the structure stands: the response is relative to it.
    BaseAcceleration,
    /// The amplitude of the response as displacement (of its first harmonic, as controllers track it).
    Displacement,
    /// The amplitude of the response as velocity.
    Velocity,
    /// The amplitude of the response as acceleration.
    Acceleration,
}

impl Control {
    /// Whether the response is held, so that the force follows from it.
    #[must_use]
    pub const fn holds_response(self) -> bool {
        matches!(self, Self::Displacement | Self::Velocity | Self::Acceleration)
    }

    /// Its name in scenarios and tables.
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

    /// Displacement amplitude of a response at `level` and the circular frequency `omega` (rad/s).
    pub(crate) fn displacement(self, level: f64, omega: f64) -> f64 {
        match self {
            Self::Velocity => level / omega,
            Self::Acceleration => level / (omega * omega),
            _ => level,
        }
    }
}

/// Steady forced responses over a band of frequencies.
#[derive(Debug, Clone, PartialEq)]
pub struct Sweep {
    /// Lower end of the band, Hz, > 0.
    pub from: f64,
    /// Upper end of the band, Hz.
    pub to: f64,
    /// What is held.
    pub control: Control,
    /// Its amplitudes, each > 0.
    pub levels: Vec<f64>,
    /// The highest harmonic of the response, odd: 1 is harmonic balance of the fundamental alone.
    pub harmonics: usize,
    /// Points per level, about; at least [`Sweep::LEAST_POINTS`].
    pub points: usize,
}

impl Sweep {
    /// Points per level at least: with fewer the two sides of a resonance are corners.
    pub const LEAST_POINTS: usize = 16;

    /// Points per level at most: a thousand times what a picture shows. They take 0.3 s and 100 MB a level.
    pub const MOST_POINTS: usize = 1_000_000;

    /// Points per level unless the user says otherwise: a resonance looks smooth at any width of a page.
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
