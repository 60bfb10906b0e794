//! Numbers in the fields of a line.

use std::fmt::Display;

use super::super::error::MeshError;
use super::super::file::{FileBytes, quote};
use super::lines::Line;

/// Numbers of nodes and elements must be smaller than this, because labels carry the number of the instance in the bits above
/// (`reader::BITS`).
const LARGEST: u64 = 1 << 40;

/// Reads a whole number > 0.
pub(super) fn whole(
    source: FileBytes,
    line: &Line,
    field: &[u8],
    what: impl Display,
) -> Result<u64, MeshError> {
    let value =
        std::str::from_utf8(field).ok().and_then(|text| text.parse().ok()).filter(|n| *n > 0 && *n < LARGEST);
    value.ok_or_else(|| {
        let expected = format!("{what}: a whole number > 0 and below {LARGEST}");
        source.malformed(line.place(source), quote(field, 40), expected)
    })
}

/// Reads a finite number; `D` is accepted as the letter of the exponent.
pub(super) fn number(
    source: FileBytes,
    line: &Line,
    field: &[u8],
    what: impl Display,
) -> Result<f64, MeshError> {
    let text = std::str::from_utf8(field).unwrap_or("no text");
    let value = text.parse().or_else(|_| text.to_ascii_lowercase().replacen('d', "e", 1).parse::<f64>());
    value.ok().filter(|value| value.is_finite()).ok_or_else(|| {
        let expected = format!("{what}: a finite number");
        source.malformed(line.place(source), quote(field, 40), expected)
    })
}
