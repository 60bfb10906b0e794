//! The crate's one error type. Each error names the quantity, the value that was given and the range that is allowed.

use core::fmt;

/// A value that the models cannot work with.
///
/// Every variant names the quantity as the user wrote it, so that callers can
/// put a file name or a key in front and print it as it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Error {
    /// A number outside its range (NaN and infinities included).
    OutOfRange {
        /// Name of the quantity.
        name: &'static str,
        /// The value that was given.
        value: f64,
        /// The allowed range, in words.
        allowed: &'static str,
    },
    /// A slice of the wrong length.
    Length {
        /// Name of the slice.
        name: &'static str,
        /// Number of entries needed.
        needed: usize,
        /// Number of entries found.
        found: usize,
    },
    /// An entry of a slice that must be ordered or non-negative and is not.
    Entry {
        /// Name of the slice.
        name: &'static str,
        /// Index of the first wrong entry.
        index: usize,
        /// The entry.
        value: f64,
        /// The allowed range, in words.
        allowed: &'static str,
    },
    /// A method was asked for something that it does not cover.
    Unsupported {
        /// What was asked for, and what to use instead.
        what: &'static str,
    },
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::OutOfRange { name, value, allowed } => {
                write!(f, "{name} = {value} is out of range: {allowed}")
            }
            Self::Length { name, needed, found } => {
                write!(f, "{name} has {found} entries, {needed} are needed")
            }
            Self::Entry { name, index, value, allowed } => {
                write!(f, "{name}[{index}] = {value} is out of range: {allowed}")
            }
            Self::Unsupported { what } => f.write_str(what),
        }
    }
}

impl core::error::Error for Error {}

/// Returns `value` when `ok` holds and `value` is finite; otherwise an error that names the quantity.
pub(crate) fn check(name: &'static str, value: f64, ok: bool, allowed: &'static str) -> Result<f64, Error> {
    if ok && value.is_finite() { Ok(value) } else { Err(Error::OutOfRange { name, value, allowed }) }
}

/// Compares the length of a slice with what is needed.
pub(crate) fn check_length(name: &'static str, found: usize, needed: usize) -> Result<(), Error> {
    if found == needed { Ok(()) } else { Err(Error::Length { name, needed, found }) }
}
