//! Why an identification was refused: which value, what is allowed, what helps.

use iwan_machine::Kind;

/// A record, option or result that the methods cannot work with.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A number outside its range (NaN and infinities included).
    #[error("{name} = {value} is out of range: {allowed}; {remedy}")]
    OutOfRange {
        /// Name of the quantity.
        name: &'static str,
        /// The value that was given or found.
        value: f64,
        /// The allowed range, in words and numbers.
        allowed: String,
        /// What helps.
        remedy: &'static str,
    },
    /// A slice of the wrong length.
    #[error("{name} has {found} entries, {needed} are needed")]
    Length {
        /// Name of the slice.
        name: &'static str,
        /// Number of entries needed.
        needed: usize,
        /// Number of entries found.
        found: usize,
    },
    /// Fewer samples, peaks or cycles than a method needs.
    #[error("{what}: {found} found, at least {needed} needed; {remedy}")]
    TooShort {
        /// What is counted.
        what: &'static str,
        /// Number found.
        found: usize,
        /// Smallest number that is enough.
        needed: usize,
        /// What helps.
        remedy: &'static str,
    },
    /// A sample that is NaN or infinite.
    #[error("{name}[{index}] = {value} is not a finite number; cut the record there or repair the sample")]
    NotFinite {
        /// Name of the slice.
        name: &'static str,
        /// Index of the first wrong sample.
        index: usize,
        /// The sample.
        value: f64,
    },
    /// The record shows something that the method must not smooth over.
    #[error("{finding}; {remedy}")]
    Refused {
        /// What was found, with numbers.
        finding: String,
        /// What helps.
        remedy: &'static str,
    },
    /// The identification was stopped from outside.
    #[error("stopped before the end")]
    Stopped,
    /// A model refused its parameters.
    #[error(transparent)]
    Model(#[from] iwan_core::Error),
}

impl Error {
    /// The error's kind in the catalogue of errors.
    #[must_use]
    pub fn kind(&self) -> Kind {
        match self {
            Self::OutOfRange { .. } | Self::Length { .. } | Self::Model(_) => Kind::Value,
            Self::TooShort { .. } => Kind::TooShort,
            Self::NotFinite { .. } => Kind::NotFinite,
            Self::Refused { .. } => Kind::Refused,
            Self::Stopped => Kind::Interrupted,
        }
    }
}

/// Passes `value` on when `ok` holds and it is finite; else the error names it.
pub(crate) fn check(
    name: &'static str,
    value: f64,
    ok: bool,
    allowed: &str,
    remedy: &'static str,
) -> Result<f64, Error> {
    if ok && value.is_finite() {
        return Ok(value);
    }
    Err(Error::OutOfRange { name, value, allowed: allowed.to_owned(), remedy })
}

/// Checks the number of samples in a cycle; the error gives it to two decimals.
pub(crate) fn check_per_cycle(
    found: f64,
    least: f64,
    allowed: &str,
    remedy: &'static str,
) -> Result<f64, Error> {
    let told = (100.0 * found).round() / 100.0;
    check("samples per cycle", told, found >= least, allowed, remedy).map(|_| found)
}

/// Checks that all samples are finite and that there are at least `needed` of them.
pub(crate) fn check_samples(
    name: &'static str,
    x: &[f64],
    needed: usize,
    remedy: &'static str,
) -> Result<(), Error> {
    if let Some(index) = x.iter().position(|v| !v.is_finite()) {
        return Err(Error::NotFinite { name, index, value: x[index] });
    }
    if x.len() < needed {
        return Err(Error::TooShort { what: "samples", found: x.len(), needed, remedy });
    }
    Ok(())
}

/// Checks that a slice has the length that is needed.
pub(crate) fn check_length(name: &'static str, found: usize, needed: usize) -> Result<(), Error> {
    if found == needed { Ok(()) } else { Err(Error::Length { name, needed, found }) }
}

/// Checks a sampling interval in seconds.
pub(crate) fn check_dt(dt: f64) -> Result<f64, Error> {
    check("dt", dt, dt > 0.0, "a sampling interval > 0 s", "give the sampling interval in seconds")
}
