//! Errors of structures and analyses: which node, element or joint is concerned, what was found, and what helps.

use iwan_machine::Kind;

/// A structure or a request that the analyses cannot work with.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A number outside its range (NaN and infinities included).
    #[error("{name} = {value} is out of range: {allowed}")]
    OutOfRange {
        /// Name of the quantity.
        name: &'static str,
        /// The value that was given.
        value: f64,
        /// The allowed range, in words and numbers.
        allowed: &'static str,
    },
    /// A number of modes that is none, or more than there are.
    #[error("{name} = {value} is out of range: 1 to {most}, as many as the structure has unknowns")]
    Modes {
        /// What the number is called.
        name: &'static str,
        /// The number that was given.
        value: usize,
        /// The largest number there can be.
        most: usize,
    },
    /// An element that is not a volume.
    #[error(
        "element {label} is inverted or collapsed: its Jacobian determinant is {determinant:.3e} at integration \
         point {point}; check the order and the positions of its nodes"
    )]
    Element {
        /// The element's number.
        label: u64,
        /// The determinant found, in volume units.
        determinant: f64,
        /// Number of the integration point, from 1.
        point: usize,
    },
    /// A node that cannot be used as requested.
    #[error("node {label}: {finding}; {remedy}")]
    Node {
        /// The node's number.
        label: u64,
        /// What was found.
        finding: String,
        /// What helps.
        remedy: &'static str,
    },
    /// A set that does not exist.
    #[error("{user} refers to the {kind} set `{name}`, which does not exist; known sets: {known}")]
    MissingSet {
        /// The joint, load or other item that refers to the set.
        user: String,
        /// `node` or `element`.
        kind: &'static str,
        /// The name that was looked up.
        name: String,
        /// The names that exist.
        known: String,
    },
    /// A mode that is not among those that were computed.
    #[error("there is no mode \"{name}\"; choose from {known}")]
    MissingMode {
        /// The name that was looked up.
        name: String,
        /// The names that exist.
        known: String,
    },
    /// A joint, tie, support or load that cannot work.
    #[error("{name}: {finding}; {remedy}")]
    Connection {
        /// Name of the joint, tie, support or load.
        name: String,
        /// What was found.
        finding: String,
        /// What helps.
        remedy: &'static str,
    },
    /// An analysis that the structure does not admit, or that failed its own check.
    #[error("{analysis}: {finding}; {remedy}")]
    Analysis {
        /// Name of the analysis.
        analysis: &'static str,
        /// What was found, with numbers.
        finding: String,
        /// What helps.
        remedy: &'static str,
    },
    /// The computation needs more memory than is available.
    #[error(transparent)]
    Memory(#[from] iwan_machine::memory::Short),
    /// The listener of the progress asked to stop.
    #[error("interrupted")]
    Interrupted,
    /// A joint law or a force refused its parameters.
    #[error(transparent)]
    Model(#[from] iwan_core::Error),
}

impl Error {
    /// The error's kind in the catalogue of errors.
    #[must_use]
    pub fn kind(&self) -> Kind {
        match self {
            Self::OutOfRange { .. } | Self::Modes { .. } | Self::Model(_) => Kind::Value,
            Self::Element { .. } | Self::Node { .. } | Self::Connection { .. } => Kind::Structure,
            Self::MissingSet { .. } => Kind::MissingSet,
            Self::MissingMode { .. } => Kind::MissingMode,
            Self::Analysis { .. } => Kind::Analysis,
            Self::Memory(_) => Kind::Memory,
            Self::Interrupted => Kind::Interrupted,
        }
    }
}

/// Returns `value` when `ok` holds and `value` is finite; otherwise an error that names the quantity.
pub(crate) fn check(name: &'static str, value: f64, ok: bool, allowed: &'static str) -> Result<f64, Error> {
    if ok && value.is_finite() { Ok(value) } else { Err(Error::OutOfRange { name, value, allowed }) }
}

/// The error of a search for more modes than the mass matrix allows.
pub(crate) fn singular_mass() -> Error {
    Error::Analysis {
        analysis: "modes",
        finding: "the search met numbers that are not finite: the mass moves fewer motions than were asked for, as that of one or two \
                  tetrahedra of 10 nodes does"
            .into(),
        remedy: "ask for fewer modes, mesh with more elements, or give mass to what has none",
    }
}
