//! Why a study could not be finished: where it was, and what the library at work there said.

use iwan_machine::Kind;

/// A study that was refused, failed or was broken off.
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
        /// What was said.
        source: iwan_core::Error,
    },
    /// Matrices, modes, transients or static curves of a structure.
    #[error("{place}: {source}")]
    Structure {
        /// What was being computed.
        place: String,
        /// What was said.
        source: iwan_fem::Error,
    },
    /// A simulation of a modal model.
    #[error("{place}: {source}")]
    Simulation {
        /// What was being computed.
        place: String,
        /// What was said.
        source: iwan_sim::SimulationError,
    },
    /// An envelope, a curve or a fit.
    #[error("{place}: {source}")]
    Identification {
        /// What was being computed.
        place: String,
        /// What was said.
        source: iwan_ident::Error,
    },
    /// A modal test.
    #[error("{place}: {source}")]
    Modal {
        /// What was being computed.
        place: String,
        /// What was said.
        source: iwan_modal::Error,
    },
    /// Measured curves that a structure cannot be updated from.
    #[error("{place}: {finding}; {remedy}")]
    Update {
        /// Which curve, mode or group of joints.
        place: String,
        /// What was found.
        finding: String,
        /// What helps.
        remedy: &'static str,
    },
    /// The observer asked to stop.
    #[error("interrupted")]
    Interrupted,
}

impl Error {
    /// Its kind in the catalogue of errors.
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
    /// Makes a law's error one of a study.
    pub(crate) fn law(place: &str) -> impl Fn(iwan_core::Error) -> Self + use<> {
        let place = place.to_owned();
        move |source| Self::Law { place: place.clone(), source }
    }

    /// Makes a structure's error one of a study; an interruption stays one.
    pub(crate) fn structure(place: &str) -> impl Fn(iwan_fem::Error) -> Self + use<> {
        let place = place.to_owned();
        move |source| match source {
            iwan_fem::Error::Interrupted => Self::Interrupted,
            source => Self::Structure { place: place.clone(), source },
        }
    }

    /// Makes a simulation's error one of a study; an interruption stays one.
    pub(crate) fn simulation(place: &str) -> impl Fn(iwan_sim::SimulationError) -> Self + use<> {
        let place = place.to_owned();
        move |source| match source {
            iwan_sim::SimulationError::Interrupted => Self::Interrupted,
            source => Self::Simulation { place: place.clone(), source },
        }
    }

    /// Makes an identification's error one of a study.
    pub(crate) fn identification(place: &str) -> impl Fn(iwan_ident::Error) -> Self + use<> {
        let place = place.to_owned();
        move |source| Self::Identification { place: place.clone(), source }
    }

    /// Makes a modal test's error one of a study.
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
