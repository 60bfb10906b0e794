//! What is wrong with an input file, where, and what helps.

/// Bad input: `file:line:column: what is wrong`, and the remedy.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{message}; {remedy}")]
pub struct InputError {
    /// Where, key, value, allowed range.
    pub message: String,
    /// What helps.
    pub remedy: String,
}

impl InputError {
    /// Bad input and what helps.
    pub fn new(message: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self { message: message.into(), remedy: remedy.into() }
    }
}
