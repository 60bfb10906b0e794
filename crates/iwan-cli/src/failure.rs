//! How a command can fail, and with which exit code.

use std::fmt;
use std::io::ErrorKind;

use iwan_input::InputError;
use iwan_io::ReadError;
use iwan_machine::memory::Short;

/// A failure with the message for the user.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Failure {
    /// Bad usage or input: exit code 2.
    Input {
        /// What is wrong, and where.
        message: String,
        /// What helps.
        remedy: String,
    },
    /// The computation failed: exit code 1.
    Computation(String),
    /// Interrupted by the user: exit code 130, as shells expect it.
    Interrupted,
}

impl Failure {
    /// Bad input and what helps.
    pub(crate) fn input(message: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self::Input { message: message.into(), remedy: remedy.into() }
    }

    /// Bad input in a library's words: what stands behind the first semicolon of its error is the remedy.
    pub(crate) fn said(place: &str, error: &impl fmt::Display) -> Self {
        let text = error.to_string();
        let (message, remedy) = text.split_once("; ").unwrap_or((&text, "check the record and the options"));
        // Errors of readers name the file themselves.
        let message = if message.starts_with(place) { message.into() } else { format!("{place}: {message}") };
        Self::input(message, remedy)
    }

    /// A record that could not be read: bad input, but for memory that is lacking.
    pub(crate) fn read(place: &str, error: &ReadError) -> Self {
        match error {
            ReadError::Io { source, .. } if source.kind() == ErrorKind::OutOfMemory => {
                Self::lacking(&format!("{place}: {source}"))
            }
            error => Self::said(place, error),
        }
    }

    /// What the machine lacks, in a library's words.
    pub(crate) fn lacking(text: &str) -> Self {
        Self::Computation(text.replacen("; ", "\nremedy: ", 1))
    }

    /// The exit code.
    pub(crate) const fn code(&self) -> u8 {
        match self {
            Self::Input { .. } => 2,
            Self::Computation(_) => 1,
            Self::Interrupted => 130,
        }
    }
}

impl From<Short> for Failure {
    fn from(short: Short) -> Self {
        Self::lacking(&short.to_string())
    }
}

impl From<InputError> for Failure {
    fn from(InputError { message, remedy }: InputError) -> Self {
        Self::Input { message, remedy }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Input { message, remedy } if remedy.is_empty() => write!(f, "error: {message}"),
            Self::Input { message, remedy } => write!(f, "error: {message}\nremedy: {remedy}"),
            Self::Computation(message) => write!(f, "error: {message}"),
            Self::Interrupted => f.write_str("interrupted: nothing was written"),
        }
    }
}
