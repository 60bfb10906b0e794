//! What can go wrong in a simulation.

/// A simulation that could not be set up or finished.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SimulationError {
    /// A parameter out of range, named.
    #[error(transparent)]
    Parameter(#[from] iwan_core::Error),
    /// A parameter of one of several modes.
    #[error("mode \"{mode}\": {source}")]
    Mode {
        /// Name of the mode.
        mode: String,
        /// What is wrong with it.
        source: Box<SimulationError>,
    },
    /// The numbers overflowed: from this time on the response is not finite.
    #[error("the response is not finite from t = {time} s on: check units, amplitude and time step")]
    NotFinite {
        /// Time of the first bad sample, s.
        time: f64,
    },
    /// The caller asked to stop.
    #[error("interrupted")]
    Interrupted,
}
