//! What is wrong with an input file: the place, the fault, and what helps.

use iwan_machine::Kind;
use iwan_machine::memory::Short;

/// An error in the input: `file:line:column: what is wrong`, and the remedy.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{message}; {remedy}")]
pub struct InputError {
    /// Place, key, value and allowed range.
    pub message: String,
    /// What helps.
    pub remedy: String,
    /// The error's kind in the catalogue of errors.
    pub kind: Kind,
}

impl InputError {
    /// An error of the kind [`Kind::Input`], with what helps.
    pub fn new(message: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self { message: message.into(), remedy: remedy.into(), kind: Kind::Input }
    }

    /// The same error with another kind.
    #[must_use]
    pub fn of(self, kind: Kind) -> Self {
        Self { kind, ..self }
    }
}

/// Becomes an error about too little memory for what the file asks, with what helps.
impl From<Short> for InputError {
    fn from(short: Short) -> Self {
        let told = short.to_string();
        let message = told.strip_suffix(&format!("; {}", short.remedy)).unwrap_or(&told);
        Self::new(message, short.remedy).of(Kind::Memory)
    }
}
