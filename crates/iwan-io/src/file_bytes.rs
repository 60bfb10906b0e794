//! The bytes of a file with its path, so that every error can name it.

use crate::error::ReadError;
use crate::options::ReadOptions;
use crate::record::RecordError;
use crate::time_unit::TimeUnit;
use iwan_machine::shortened;
use std::path::Path;

/// A file in memory.
#[derive(Clone, Copy)]
pub(crate) struct FileBytes<'a> {
    pub(crate) file: &'a Path,
    pub(crate) bytes: &'a [u8],
}

impl FileBytes<'_> {
    pub(crate) fn malformed(
        &self,
        place: impl Into<String>,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> ReadError {
        let (place, found, expected) = (place.into(), found.into(), expected.into());
        ReadError::Malformed { file: self.file.into(), place, found, expected }
    }

    pub(crate) fn unsupported(
        &self,
        place: impl Into<String>,
        found: impl Into<String>,
        remedy: impl Into<String>,
    ) -> ReadError {
        let (place, found, remedy) = (place.into(), found.into(), remedy.into());
        ReadError::Unsupported { file: self.file.into(), place, found, remedy }
    }

    pub(crate) fn cut_short(
        &self,
        place: impl Into<String>,
        what: &'static str,
        promised: u64,
        found: u64,
    ) -> ReadError {
        ReadError::CutShort { file: self.file.into(), place: place.into(), what, promised, found }
    }

    /// Factor from the unit of the times to seconds, and whether that unit is known. The user's unit overrides the file's; where the user
    /// gives a sampling rate, an unknown unit is no error, because the times are then not used.
    pub(crate) fn seconds(
        &self,
        name: &str,
        unit: &str,
        options: &ReadOptions,
    ) -> Result<(f64, bool), ReadError> {
        if let Some(given) = options.time_unit {
            return Ok((given.seconds(), true));
        }
        let bare = unit.trim().trim_matches(['[', ']', '(', ')', '{', '}', '<', '>']).trim();
        match bare.parse::<TimeUnit>() {
            Ok(unit) => Ok((unit.seconds(), true)),
            Err(_) if bare.is_empty() => Ok((1.0, false)),
            Err(_) if options.rate.is_some() => Ok((1.0, true)),
            Err(_) => {
                let counts =
                    ["sample", "point", "index", "count"].iter().any(|w| bare.to_lowercase().starts_with(w));
                let remedy = if counts {
                    "it counts samples: give the sampling rate with --rate HZ"
                } else {
                    "say what the times are with --time-unit s|ms|us|ns|min|h, or give --rate HZ"
                };
                let (file, name, unit) = (self.file.into(), name.into(), shortened(bare, 40));
                Err(ReadError::TimeUnit { file, name, unit, known: TimeUnit::KNOWN, remedy })
            }
        }
    }

    pub(crate) fn record(&self, source: RecordError) -> ReadError {
        ReadError::Record { file: self.file.into(), source }
    }
}

/// Text of a header: UTF-8 where the bytes are valid UTF-8, else Latin-1, as older analysers write it.
pub(crate) fn decode(bytes: &[u8]) -> String {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.into(),
        Err(_) => bytes.iter().map(|&b| char::from(b)).collect(),
    }
}
