//! What is wrong with an input file, where, and what helps.

use iwan_machine::Kind;
use iwan_machine::memory::Short;

/// Bad input: `file:line:column: what is wrong`, and the remedy.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{message}; {remedy}")]
pub struct InputError {
    /// Where, key, value, allowed range.
    pub message: String,
    /// What helps.
    pub remedy: String,
    /// Its kind in the catalogue of errors.
    pub kind: Kind,
}

impl InputError {
    /// Bad input and what helps.
    pub fn new(message: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self { message: message.into(), remedy: remedy.into(), kind: Kind::Input }
    }

    /// The same as an error of another kind.
    #[must_use]
    pub fn of(self, kind: Kind) -> Self {
        Self { kind, ..self }
    }
}

/// Too little memory for what the file asks, and what helps.
impl From<Short> for InputError {
    fn from(short: Short) -> Self {
        let told = short.to_string();
        let message = told.strip_suffix(&format!("; {}", short.remedy)).unwrap_or(&told);
        Self::new(message, short.remedy).of(Kind::Memory)
    }
}
