//! Why a study could not be finished: what was being computed, and the error of the library that was at work.

use iwan_machine::Kind;

/// A study that was refused, failed or was interrupted.
///
/// `place` says what was being computed, such as `configuration A, bending 1`.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A joint law with parameters out of range.
    #[error("{place}: {source}")]
    Law {
        /// What was being computed.
        place: String,
        /// The library's error.
        source: iwan_core::Error,
    },
    /// Matrices, modes, transients or static curves of a structure.
    #[error("{place}: {source}")]
    Structure {
        /// What was being computed.
        place: String,
        /// The library's error.
        source: iwan_fem::Error,
    },
    /// A simulation of a modal model.
    #[error("{place}: {source}")]
    Simulation {
        /// What was being computed.
        place: String,
        /// The library's error.
        source: iwan_sim::SimulationError,
    },
    /// An envelope, a curve or a fit.
    #[error("{place}: {source}")]
    Identification {
        /// What was being computed.
        place: String,
        /// The library's error.
        source: iwan_ident::Error,
    },
    /// A modal test.
    #[error("{place}: {source}")]
    Modal {
        /// What was being computed.
        place: String,
        /// The library's error.
        source: iwan_modal::Error,
    },
    /// Measured curves from which a structure cannot be updated.
    #[error("{place}: {finding}; {remedy}")]
    Update {
        /// The curve, mode or group of joints concerned.
        place: String,
        /// What is wrong.
        finding: String,
        /// What the user can do.
        remedy: &'static str,
    },
    /// The observer of the progress asked to stop.
    #[error("interrupted")]
    Interrupted,
}

impl Error {
    /// Kind in the catalogue of errors.
    #[must_use]
    pub fn kind(&self) -> Kind {
        match self {
            Self::Law { .. } => Kind::Value,
            Self::Structure { source, .. } => source.kind(),
            Self::Simulation { source, .. } => source.kind(),
            Self::Identification { source, .. } => source.kind(),
            Self::Modal { source, .. } => source.kind(),
            Self::Update { .. } => Kind::Refused,
            Self::Interrupted => Kind::Interrupted,
        }
    }
}

impl Error {
    /// Turns a law's error into one of a study.
    pub(crate) fn law(place: &str) -> impl Fn(iwan_core::Error) -> Self + use<> {
        let place = place.to_owned();
        move |source| Self::Law { place: place.clone(), source }
    }

    /// Turns a structure's error into one of a study; an interruption remains an interruption.
    pub(crate) fn structure(place: &str) -> impl Fn(iwan_fem::Error) -> Self + use<> {
        let place = place.to_owned();
        move |source| match source {
            iwan_fem::Error::Interrupted => Self::Interrupted,
            source => Self::Structure { place: place.clone(), source },
        }
    }

    /// Turns a simulation's error into one of a study; an interruption remains an interruption.
    pub(crate) fn simulation(place: &str) -> impl Fn(iwan_sim::SimulationError) -> Self + use<> {
        let place = place.to_owned();
        move |source| match source {
            iwan_sim::SimulationError::Interrupted => Self::Interrupted,
            source => Self::Simulation { place: place.clone(), source },
        }
    }

    /// Turns an identification's error into one of a study.
    pub(crate) fn identification(place: &str) -> impl Fn(iwan_ident::Error) -> Self + use<> {
        let place = place.to_owned();
        move |source| Self::Identification { place: place.clone(), source }
    }

    /// Turns a modal test's error into one of a study.
    pub(crate) fn modal(place: &str) -> impl Fn(iwan_modal::Error) -> Self + use<> {
        let place = place.to_owned();
        move |source| Self::Modal { place: place.clone(), source }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_says_where_it_was_and_an_interruption_stays_one() {
        let failed = Error::law("mode 1")(iwan_core::Error::Unsupported { what: "this does not work" });
        assert!(failed.to_string().starts_with("mode 1: "), "{failed}");
        assert_eq!(Error::structure("beam")(iwan_fem::Error::Interrupted), Error::Interrupted);
        let stopped = iwan_sim::SimulationError::Interrupted;
        assert_eq!(Error::simulation("mode 1")(stopped), Error::Interrupted);
    }
}
