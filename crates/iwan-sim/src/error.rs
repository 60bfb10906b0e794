//! Errors of a simulation.

use iwan_machine::Kind;

/// A simulation that could not be set up or finished.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SimulationError {
    /// A parameter out of range; the error names it.
    #[error(transparent)]
    Parameter(#[from] iwan_core::Error),
    /// An error in one of several modes.
    #[error("mode \"{mode}\": {source}")]
    Mode {
        /// Name of the mode.
        mode: String,
        /// The error in that mode.
        source: Box<SimulationError>,
    },
    /// An error in a joint that modes share.
    #[error("joint \"{joint}\": {source}")]
    Joint {
        /// Name of the joint.
        joint: String,
        /// The error in that joint.
        source: Box<SimulationError>,
    },
    /// The numbers overflowed; from the given time on the response is not finite.
    #[error("the response is not finite from t = {time} s on: check units, amplitude and time step")]
    NotFinite {
        /// Time of the first bad sample, s.
        time: f64,
    },
    /// A softening spring has cancelled all stiffness of the mode, so that its step has no solution.
    #[error(
        "from t = {time} s on the springs that soften leave the mode no stiffness, and it runs away: lower the amplitude, or \
         the spring's |k|"
    )]
    NoStiffness {
        /// Time of the first sample without a solution, s.
        time: f64,
    },
    /// The motion went beyond the largest amplitude of the mode's curves.
    #[error(
        "the amplitude reaches {amplitude:e}, beyond the largest of the curves, {largest:e}, for the first time at t = {time} s: \
         measure there, lower the force, or allow it with extrapolate = true, which holds the last values"
    )]
    BeyondCurves {
        /// Largest amplitude of the motion.
        amplitude: f64,
        /// Largest amplitude of the curves.
        largest: f64,
        /// Time at which the motion first goes beyond, s.
        time: f64,
    },
    /// The computation needs more memory than is available.
    #[error(transparent)]
    Memory(#[from] iwan_machine::memory::Short),
    /// The caller asked to stop.
    #[error("interrupted")]
    Interrupted,
}

impl SimulationError {
    /// The error's kind in the catalogue of errors.
    #[must_use]
    pub fn kind(&self) -> Kind {
        match self {
            Self::Parameter(_) => Kind::Value,
            Self::Mode { source, .. } | Self::Joint { source, .. } => source.kind(),
            Self::NotFinite { .. } => Kind::Overflow,
            Self::NoStiffness { .. } => Kind::NoStiffness,
            Self::BeyondCurves { .. } => Kind::BeyondCurves,
            Self::Memory(_) => Kind::Memory,
            Self::Interrupted => Kind::Interrupted,
        }
    }
}
