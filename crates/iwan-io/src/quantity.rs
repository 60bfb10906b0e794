//! The physical quantities that samples measure.

use std::fmt;

/// What the samples of a record measure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[non_exhaustive]
pub enum Quantity {
    /// Second time derivative of displacement, for instance in m/s^2 or g, or of an angle.
    Acceleration,
    /// First time derivative of displacement, for instance in m/s, or of an angle.
    Velocity,
    /// Displacement, for instance in m, or an angle, for instance in deg.
    Displacement,
    /// Force, for instance in N.
    Force,
    /// Pressure, for instance of sound, in Pa.
    Pressure,
    /// Voltage of a sensor whose sensitivity is not applied, in V.
    Voltage,
    /// Strain, for instance of a gauge.
    Strain,
    /// The file does not say, or names something else.
    #[default]
    Unknown,
}

impl Quantity {
    /// Whether it is a motion: a displacement or one of its derivatives.
    ///
    /// ```
    /// assert!(iwan_io::Quantity::Velocity.is_motion() && !iwan_io::Quantity::Pressure.is_motion());
    /// ```
    #[must_use]
    pub fn is_motion(self) -> bool {
        matches!(self, Self::Acceleration | Self::Velocity | Self::Displacement)
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Acceleration => "acceleration",
            Self::Velocity => "velocity",
            Self::Displacement => "displacement",
            Self::Force => "force",
            Self::Pressure => "pressure",
            Self::Voltage => "voltage",
            Self::Strain => "strain",
            Self::Unknown => "unknown",
        })
    }
}
