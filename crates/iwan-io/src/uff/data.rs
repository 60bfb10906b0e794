//! Record 12 of a dataset 58: the values, as text or in binary.

use super::header::Header;
use super::sections::{Binary, Section, line_at};
use crate::bytes::{NumberType, to_f64};
use crate::error::ReadError;
use crate::file_bytes::{FileBytes, decode};
use crate::warning::Warning;
use iwan_machine::shortened;

/// Least part of the promised points with which a dataset is read. With fewer points it is refused as cut short; with more, but not all,
/// the count is taken to be wrong, and a warning says so. Wrong counts known from an analyser are off by a few points in 222,400; a file
/// known to be cut short has 42 of 2,508,876: any part from 0.01 to 0.999 tells these apart.
const LEAST_PART: f64 = 0.9;

/// The points of a dataset.
pub(super) struct Points {
    /// Times of the points; empty for an even abscissa.
    pub(super) times: Vec<f64>,
    pub(super) values: Vec<f64>,
}

impl Points {
    fn even(values: Vec<f64>) -> Self {
        Self { times: Vec::new(), values }
    }

    /// Points from numbers that are abscissa and ordinate in turn.
    fn in_turn(pairs: &[f64]) -> Self {
        let (times, values) = pairs.chunks_exact(2).map(|p| (p[0], p[1])).unzip();
        Self { times, values }
    }
}

pub(super) fn read(
    source: &FileBytes,
    section: &Section,
    header: &Header,
    warnings: &mut Vec<Warning>,
) -> Result<Points, ReadError> {
    if !matches!(header.data_type, 2 | 4) {
        let place = format!("{}, record 7, field 1", section.place());
        let found = format!("ordinate data type {}", header.data_type);
        return Err(source.malformed(place, found, "2 or 4 (real), 5 or 6 (complex)"));
    }
    let points = match section.binary {
        Some(binary) => binary_values(section, header, binary),
        None if header.even => Points::even(text_values(source, section, &widths(header))?),
        None => Points::in_turn(&text_values(source, section, &widths(header))?),
    };
    check_count(source, section, header, points.values.len(), warnings)?;
    Ok(points)
}

/// Values over an even abscissa: real parts, and imaginary parts, which are empty for a real function.
pub(super) fn read_any(
    source: &FileBytes,
    section: &Section,
    header: &Header,
    warnings: &mut Vec<Warning>,
) -> Result<(Vec<f64>, Vec<f64>), ReadError> {
    if !matches!(header.data_type, 5 | 6) {
        return Ok((read(source, section, header, warnings)?.values, Vec::new()));
    }
    let values = match section.binary {
        Some(Binary { order, .. }) => {
            let kind = if header.data_type == 6 { NumberType::F64 } else { NumberType::F32 };
            to_f64(section.data, kind, order)
        }
        None => text_values(source, section, &if header.data_type == 6 { [20, 20] } else { [13, 13] })?,
    };
    let (re, im): (Vec<f64>, Vec<f64>) = values.chunks_exact(2).map(|p| (p[0], p[1])).unzip();
    check_count(source, section, header, re.len(), warnings)?;
    Ok((re, im))
}

fn check_count(
    source: &FileBytes,
    section: &Section,
    header: &Header,
    found: usize,
    warnings: &mut Vec<Warning>,
) -> Result<(), ReadError> {
    let promised = header.points;
    if found == 0 || (found as f64) < LEAST_PART * promised as f64 {
        return Err(source.cut_short(section.place(), "points", promised, found as u64));
    }
    if promised != found as u64 {
        warnings.push(Warning::Count { place: section.place(), promised, found });
    }
    if !section.closed {
        warnings.push(Warning::Unclosed { place: section.place() });
    }
    Ok(())
}

/// Points of binary data. Over an even abscissa the data are the ordinates alone, over an uneven one abscissa and ordinate in turn. In
/// double precision each abscissa has four bytes by the format's own rule (addendum B), but eight bytes in files of some programs: the
/// number of data bytes shows which.
fn binary_values(section: &Section, header: &Header, binary: Binary) -> Points {
    let (data, order) = (section.data, binary.order);
    let kind = if header.data_type == 4 { NumberType::F64 } else { NumberType::F32 };
    if header.even {
        return Points::even(to_f64(data, kind, order));
    }
    let wide = header.points.checked_mul(16) == Some(data.len() as u64);
    if kind == NumberType::F32 || wide {
        return Points::in_turn(&to_f64(data, kind, order));
    }
    let (mut times, mut values) = (Vec::new(), Vec::new());
    for pair in data.chunks_exact(12) {
        times.extend(to_f64(&pair[..4], NumberType::F32, order));
        values.extend(to_f64(&pair[4..], NumberType::F64, order));
    }
    Points { times, values }
}

/// Widths in characters of two successive fields of a line: 6E13.5, 4E20.12, 2(E13.5,E20.12).
fn widths(header: &Header) -> [usize; 2] {
    match (header.data_type, header.even) {
        (4, true) => [20, 20],
        (4, false) => [13, 20],
        _ => [13, 13],
    }
}

fn text_values(source: &FileBytes, section: &Section, widths: &[usize; 2]) -> Result<Vec<f64>, ReadError> {
    let mut values = Vec::with_capacity(section.data.len() / 13);
    let (mut at, mut number) = (0, 0);
    while let Some((line, next)) = line_at(section.data, at) {
        at = next;
        number += 1;
        let before = values.len();
        if push_words(line, &mut values).is_some() {
            continue;
        }
        values.truncate(before);
        if push_fields(line, widths, &mut values).is_none() {
            let place = format!("{}, data line {number}", section.place());
            let found = format!("'{}'", shortened(decode(line).trim(), 80));
            return Err(source.malformed(place, found, "numbers"));
        }
    }
    Ok(values)
}

/// Adds the numbers of a line, separated by blanks; none where a word is no number.
fn push_words(line: &[u8], values: &mut Vec<f64>) -> Option<()> {
    for word in line.split(u8::is_ascii_whitespace).filter(|w| !w.is_empty()) {
        values.push(number(word)?);
    }
    Some(())
}

/// Adds the numbers of a line by the widths of their fields, for lines in which numbers touch each other; none where a field holds no
/// number.
fn push_fields(mut line: &[u8], widths: &[usize; 2], values: &mut Vec<f64>) -> Option<()> {
    for width in widths.iter().cycle() {
        if line.trim_ascii().is_empty() {
            return Some(());
        }
        let (field, rest) = line.split_at((*width).min(line.len()));
        values.push(number(field.trim_ascii())?);
        line = rest;
    }
    Some(())
}

fn number(word: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(word).ok()?;
    text.parse().ok().or_else(|| text.replace(['D', 'd'], "e").parse().ok())
}
