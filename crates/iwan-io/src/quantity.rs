//! What samples measure.

use std::fmt;

/// What the samples of a record measure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[non_exhaustive]
pub enum Quantity {
    /// Second time derivative of displacement, for instance in m/s^2 or g.
    Acceleration,
    /// First time derivative of displacement, for instance in m/s.
    Velocity,
    /// Displacement, for instance in m.
    Displacement,
    /// Force, for instance in N.
    Force,
    /// The file does not say, or names something else (a sound pressure, a strain).
    #[default]
    Unknown,
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Acceleration => "acceleration",
            Self::Velocity => "velocity",
            Self::Displacement => "displacement",
            Self::Force => "force",
            Self::Unknown => "unknown",
        })
    }
}
