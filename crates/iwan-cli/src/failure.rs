//! How a command can fail, and with which exit code.

use std::fmt;
use std::io::ErrorKind;

use iwan_input::InputError;
use iwan_io::ReadError;
use iwan_machine::memory::Short;
use iwan_machine::{Kind, lacking};
use serde::Serialize;

use crate::shown;

/// Version of iwan, as results, pages and error messages carry it.
pub(crate) const VERSION: &str = env!("CARGO_PKG_VERSION");

/// A failure with the message for the user, and its kind in the catalogue of errors.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Failure {
    /// Bad usage or input: exit code 2.
    Input {
        /// Kind of the error in the catalogue.
        kind: Kind,
        /// What is wrong, and in which file, key or option.
        message: String,
        /// What the user can do about it.
        remedy: String,
    },
    /// The computation failed: exit code 1.
    Computation {
        /// Kind of the error in the catalogue.
        kind: Kind,
        /// What failed, and what the user can do about it.
        message: String,
    },
    /// Interrupted by the user: exit code 130, as shells expect it.
    Interrupted,
}

/// An error type of a library that names its kind in the catalogue of errors.
pub(crate) trait Kinded: fmt::Display {
    /// Kind of this error in the catalogue.
    fn its_kind(&self) -> Kind;
}

macro_rules! kinded {
    ($($error:ty),*) => {
        $(impl Kinded for $error {
            fn its_kind(&self) -> Kind {
                self.kind()
            }
        })*
    };
}

kinded!(
    ReadError,
    iwan_io::RecordError,
    iwan_ident::Error,
    iwan_modal::Error,
    iwan_fem::Error,
    iwan_study::Error,
    iwan_sim::SimulationError,
    iwan_io::atomic::WriteError
);

/// The JSON object that a program reads on standard output in place of the summary.
#[derive(Serialize)]
struct Told<'a> {
    version: &'static str,
    error: Error<'a>,
}

#[derive(Serialize)]
struct Error<'a> {
    kind: &'static str,
    exit_code: u8,
    message: &'a str,
    #[serde(skip_serializing_if = "str::is_empty")]
    remedy: &'a str,
}

impl Failure {
    /// A failure by bad input, with its remedy.
    pub(crate) fn input(message: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self::Input { kind: Kind::Input, message: message.into(), remedy: remedy.into() }
    }

    /// A failure of the computation.
    pub(crate) fn computation(message: impl Into<String>) -> Self {
        Self::Computation { kind: Kind::Failed, message: message.into() }
    }

    /// The same failure with another kind.
    pub(crate) fn of(mut self, new: Kind) -> Self {
        if let Self::Input { kind, .. } | Self::Computation { kind, .. } = &mut self {
            *kind = new;
        }
        self
    }

    /// A failure by bad input in a library's words: the text behind the first semicolon of the library's error is the remedy.
    /// Where memory is lacking, the input is not to blame: then it is one of the computation.
    pub(crate) fn said(place: &str, error: &impl Kinded) -> Self {
        let text = error.to_string();
        if error.its_kind() == Kind::Memory {
            return Self::lacking(&format!("{place}: {text}"));
        }
        let (message, remedy) = text.split_once("; ").unwrap_or((&text, "check the record and the options"));
        // Errors of file readers begin with the file's name already.
        let message = if message.starts_with(place) { message.into() } else { format!("{place}: {message}") };
        Self::input(message, remedy).of(error.its_kind())
    }

    /// The same failure with a second remedy, `other`.
    pub(crate) fn or(mut self, other: &str) -> Self {
        if let Self::Input { remedy, .. } = &mut self {
            *remedy = format!("{remedy}; or {other}");
        }
        self
    }

    /// A record that could not be read: bad input, except where the machine lacks memory or handles of files.
    pub(crate) fn read(place: &str, error: &ReadError) -> Self {
        match error {
            ReadError::Io { source, .. } if lacking(source).is_some() => {
                Self::computation(error.to_string().replacen("; ", "\nremedy: ", 1)).of(Kind::Unreadable)
            }
            ReadError::Io { source, .. } if source.kind() == ErrorKind::OutOfMemory => {
                Self::lacking(&format!("{place}: {source}"))
            }
            error => Self::said(place, error),
        }
    }

    /// A failure because the machine lacks memory, in a library's words.
    pub(crate) fn lacking(text: &str) -> Self {
        Self::computation(text.replacen("; ", "\nremedy: ", 1)).of(Kind::Memory)
    }

    /// The exit code of the program.
    pub(crate) const fn code(&self) -> u8 {
        match self {
            Self::Input { .. } => 2,
            Self::Computation { .. } => 1,
            Self::Interrupted => 130,
        }
    }

    /// Kind of the failure in the catalogue.
    pub(crate) const fn kind(&self) -> Kind {
        match self {
            Self::Input { kind, .. } | Self::Computation { kind, .. } => *kind,
            Self::Interrupted => Kind::Interrupted,
        }
    }

    /// The failure as one JSON object.
    pub(crate) fn json(&self) -> String {
        let shown = iwan_machine::brief(&self.to_string());
        let text = shown.strip_prefix("error: ").unwrap_or(&shown);
        let (message, remedy) =
            text.split_once("\nremedy: ").or_else(|| text.split_once("; ")).unwrap_or((text, ""));
        let error = Error { kind: self.kind().name(), exit_code: self.code(), message, remedy };
        shown::json(&Told { version: VERSION, error })
    }
}

impl From<Short> for Failure {
    fn from(short: Short) -> Self {
        Self::lacking(&short.to_string())
    }
}

impl From<InputError> for Failure {
    fn from(InputError { message, remedy, kind }: InputError) -> Self {
        Self::Input { kind, message, remedy }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Input { message, remedy, .. } if remedy.is_empty() => write!(f, "error: {message}"),
            Self::Input { message, remedy, .. } => write!(f, "error: {message}\nremedy: {remedy}"),
            Self::Computation { message, .. } => write!(f, "error: {message}"),
            Self::Interrupted => f.write_str("interrupted: nothing was written"),
        }
    }
}
