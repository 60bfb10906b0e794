//! Why a modal analysis was refused: which hit and channel, what was found, what helps.

use iwan_machine::Kind;

/// Measurements or settings that the methods cannot work with.
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
    /// A sample that is NaN or infinite.
    #[error(
        "{place}: sample {index} is {value}, not a finite number; cut the record there or repair the sample"
    )]
    NotFinite {
        /// File and channel.
        place: String,
        /// Index of the first wrong sample, counted from 0.
        index: usize,
        /// The sample.
        value: f64,
    },
    /// Measurements that do not belong together, or that show something that must not be smoothed over.
    #[error("{place}: {finding}; {remedy}")]
    Refused {
        /// File and channel, or what was to be computed.
        place: String,
        /// What was found, with numbers.
        finding: String,
        /// What helps.
        remedy: &'static str,
    },
    /// A record that its own analysis refused.
    #[error("{place}: {source}")]
    Record {
        /// File and channel.
        place: String,
        /// Why.
        source: iwan_ident::Error,
    },
    /// Memory is lacking.
    #[error(transparent)]
    Memory(#[from] iwan_machine::memory::Short),
}

impl Error {
    /// The error's kind in the catalogue of errors.
    #[must_use]
    pub fn kind(&self) -> Kind {
        match self {
            Self::OutOfRange { .. } => Kind::Value,
            Self::NotFinite { .. } => Kind::NotFinite,
            Self::Refused { .. } => Kind::Refused,
            Self::Record { source, .. } => source.kind(),
            Self::Memory(_) => Kind::Memory,
        }
    }
}

impl Error {
    pub(crate) fn refused(
        place: impl Into<String>,
        finding: impl Into<String>,
        remedy: &'static str,
    ) -> Self {
        Self::Refused { place: place.into(), finding: finding.into(), remedy }
    }
}

/// Passes `value` on when `ok` holds and it is finite; else the error names it.
pub(crate) fn check(
    name: &'static str,
    value: f64,
    ok: bool,
    allowed: impl Into<String>,
    remedy: &'static str,
) -> Result<f64, Error> {
    if ok && value.is_finite() {
        return Ok(value);
    }
    Err(Error::OutOfRange { name, value, allowed: allowed.into(), remedy })
}

/// Checks the edges of a band, Hz; `ok_above` says whether the upper one is allowed.
pub(crate) fn check_band(
    (low, high): (f64, f64),
    ok_above: bool,
    allowed_above: impl Into<String>,
) -> Result<(), Error> {
    let remedy = "choose a band within the measured frequencies";
    let ok = low > 0.0 && low < high;
    check("lower edge of the band", low, ok, "above 0 and below the upper edge", remedy)?;
    check("upper edge of the band", high, ok_above, allowed_above, remedy)?;
    Ok(())
}
