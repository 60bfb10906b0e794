//! MATLAB level 5 MAT-files: sparse and full matrices of real numbers, plain or compressed ("MAT-File Format", The MathWorks).

use flate2::bufread::ZlibDecoder;

use super::numbers::{Class, Kind, inflate};
use crate::error::ExchangeError;
use crate::matrix::{Entry, Matrix, Stored};
use crate::source::{MOST_ROWS, Source, quote};

/// Bytes before the first data element: 116 of text, 8 of offsets, version and byte order.
const HEADER: usize = 128;
/// Types of data elements.
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;
/// Classes of arrays.
const SPARSE: u8 = 5;

/// A data element.
struct Element<'a> {
    kind: u32,
    data: &'a [u8],
}

/// Elements one after another.
struct Elements<'s, 'a> {
    source: &'s Source<'s>,
    bytes: &'a [u8],
    at: usize,
    big: bool,
    place: String,
}

impl<'a> Elements<'_, 'a> {
    fn word(&self, at: usize) -> Option<u32> {
        let raw = *self.bytes.get(at..)?.first_chunk()?;
        Some(if self.big { u32::from_be_bytes(raw) } else { u32::from_le_bytes(raw) })
    }

    fn next(&mut self) -> Result<Option<Element<'a>>, ExchangeError> {
        if self.at >= self.bytes.len() {
            return Ok(None);
        }
        let cut = |at: usize| {
            let found = format!("an element at byte {} that is cut short", at + 1);
            self.source.malformed(self.place.clone(), found, "a whole data element")
        };
        let first = self.word(self.at).ok_or_else(|| cut(self.at))?;
        // Up to four bytes of data stand in the tag itself.
        if first >> 16 != 0 {
            let (kind, length) = (first & 0xffff, (first >> 16) as usize);
            let data = self.bytes.get(self.at + 4..).and_then(|rest| rest.get(..length.min(4)));
            let data = data.ok_or_else(|| cut(self.at))?;
            self.at += 8;
            return Ok(Some(Element { kind, data }));
        }
        let length = self.word(self.at + 4).ok_or_else(|| cut(self.at))? as usize;
        let data =
            self.bytes.get(self.at + 8..).and_then(|rest| rest.get(..length)).ok_or_else(|| cut(self.at))?;
        let padded = if first == COMPRESSED { length } else { length.div_ceil(8) * 8 };
        self.at += 8 + padded;
        Ok(Some(Element { kind: first, data }))
    }

    fn expect(&mut self, what: &str) -> Result<Element<'a>, ExchangeError> {
        let next = self.next()?;
        next.ok_or_else(|| self.source.malformed(self.place.clone(), "nothing more", what))
    }

    /// An element of numbers.
    fn numbers(&mut self, what: &str) -> Result<(Kind, &'a [u8]), ExchangeError> {
        let element = self.expect(what)?;
        let (class, size) = match element.kind {
            1 => (Class::Signed, 1),
            2 => (Class::Unsigned, 1),
            3 => (Class::Signed, 2),
            4 => (Class::Unsigned, 2),
            5 => (Class::Signed, 4),
            6 => (Class::Unsigned, 4),
            7 => (Class::Float, 4),
            9 => (Class::Float, 8),
            12 => (Class::Signed, 8),
            13 => (Class::Unsigned, 8),
            other => {
                let found = format!("data of type {other}");
                return Err(self.source.malformed(self.place.clone(), found, what));
            }
        };
        Ok((Kind { size, class, big: self.big }, element.data))
    }
}

pub(crate) fn parse(source: &Source) -> Result<Vec<Matrix>, ExchangeError> {
    let big = byte_order(source)?;
    let mut elements =
        Elements { source, bytes: &source.bytes[HEADER..], at: 0, big, place: "the file".to_string() };
    let mut matrices = Vec::new();
    while let Some(element) = elements.next()? {
        if element.kind == MATRIX {
            matrices.extend(array(source, element.data, big)?);
        } else if element.kind == COMPRESSED {
            let bytes = inflate(&mut ZlibDecoder::new(element.data), element.data.len())
                .map_err(|e| source.malformed("a compressed variable", e.to_string(), "zlib data"))?;
            let place = "a compressed variable".to_string();
            let mut inside = Elements { source, bytes: &bytes, at: 0, big, place };
            while let Some(element) = inside.next()? {
                if element.kind == MATRIX {
                    matrices.extend(array(source, element.data, big)?);
                }
            }
        }
    }
    if matrices.is_empty() { Err(source.ends("a variable that is a real matrix")) } else { Ok(matrices) }
}

/// Whether numbers stand with their largest byte first.
fn byte_order(source: &Source) -> Result<bool, ExchangeError> {
    let bytes = source.bytes;
    let remedy = "save it again with save(..., '-v7')";
    if bytes.starts_with(b"\x89HDF") || bytes.starts_with(b"MATLAB 7.3") {
        return Err(source.unsupported("the header", "a MATLAB v7.3 (HDF5) file", remedy));
    }
    match bytes.get(124..HEADER) {
        Some([0, 1, b'I', b'M']) => Ok(false),
        Some([1, 0, b'M', b'I']) => Ok(true),
        _ => {
            let found = quote(&bytes[..bytes.len().min(20)], 20);
            Err(source.malformed(
                "the header",
                found,
                "that of a level 5 MAT-file; save(..., '-v7') writes one",
            ))
        }
    }
}

/// A matrix of real numbers; none for what is no such matrix.
fn array(source: &Source, data: &[u8], big: bool) -> Result<Option<Matrix>, ExchangeError> {
    let mut parts = Elements { source, bytes: data, at: 0, big, place: "a variable".to_string() };
    let flags = parts.expect("array flags")?;
    let flags = Elements { source, bytes: flags.data, at: 0, big, place: String::new() }.word(0);
    let Some([class, bits, ..]) = flags.map(u32::to_le_bytes) else {
        return Err(source.malformed("a variable", "short array flags", "8 bytes"));
    };
    if class != SPARSE && !(6..=15).contains(&class) {
        return Ok(None);
    }
    let (kind, dims) = parts.numbers("dimensions")?;
    let sizes: Vec<usize> =
        (0..kind.count(dims)).filter_map(|at| kind.at(dims, at)).map(|n| n as usize).collect();
    let name = String::from_utf8_lossy(parts.expect("a name")?.data).into_owned();
    parts.place = format!("variable '{name}'");
    let [rows, columns] = sizes[..] else { return Ok(None) };
    if rows as u64 > MOST_ROWS || columns as u64 > MOST_ROWS {
        return Err(source.malformed(
            parts.place,
            format!("{rows} x {columns}"),
            format!("at most {MOST_ROWS} rows"),
        ));
    }
    let entries = if class == SPARSE {
        sparse(&mut parts, [rows, columns])?
    } else {
        full(&mut parts, [rows, columns])?
    };
    Ok(Some(Matrix {
        name,
        rows,
        columns,
        entries,
        stored: Stored::All,
        labels: None,
        complex: bits & 8 != 0,
    }))
}

/// Row indices, starts of columns and values.
fn sparse(parts: &mut Elements, [rows, columns]: [usize; 2]) -> Result<Vec<Entry>, ExchangeError> {
    let ((ik, ir), (jk, jc), (vk, pr)) =
        (parts.numbers("row indices")?, parts.numbers("column starts")?, parts.numbers("values")?);
    let bad = |found: String, expected: String| parts.source.malformed(parts.place.clone(), found, expected);
    if jk.count(jc) != columns + 1 {
        return Err(bad(format!("{} column starts", jk.count(jc)), format!("{}", columns + 1)));
    }
    let (mut entries, mut from) = (Vec::new(), 0);
    let count = ik.count(ir).min(vk.count(pr));
    for column in 0..columns {
        let to = jk.at(jc, column + 1).filter(|n| *n >= from as f64 && *n <= count as f64);
        let Some(to) = to else {
            return Err(bad(
                format!("start {:?} of column {}", jk.at(jc, column + 1), column + 2),
                format!("{from} to {count}"),
            ));
        };
        for at in from..to as usize {
            let row = ik.at(ir, at).filter(|row| *row >= 0.0 && *row < rows as f64);
            let value = vk.at(pr, at).filter(|value| value.is_finite());
            let (Some(row), Some(value)) = (row, value) else {
                let (row, value) = (ik.at(ir, at).unwrap_or(f64::NAN), vk.at(pr, at).unwrap_or(f64::NAN));
                let found = format!("row {} with value {value} in column {}", row + 1.0, column + 1);
                return Err(bad(found, format!("a row from 1 to {rows} and a finite number")));
            };
            entries.push((row as u32, column as u32, value));
        }
        from = to as usize;
    }
    Ok(entries)
}

/// Column after column.
fn full(parts: &mut Elements, [rows, columns]: [usize; 2]) -> Result<Vec<Entry>, ExchangeError> {
    let (kind, data) = parts.numbers("values")?;
    if rows.checked_mul(columns) != Some(kind.count(data)) {
        let found = format!("{} values for {rows} x {columns}", kind.count(data));
        return Err(parts.source.malformed(
            parts.place.clone(),
            found,
            "as many values as the dimensions say",
        ));
    }
    let mut entries = Vec::new();
    for at in 0..kind.count(data) {
        let value = kind.at(data, at).unwrap_or(f64::NAN);
        if !value.is_finite() {
            let found = format!("{value} in row {}, column {}", at % rows + 1, at / rows + 1);
            return Err(parts.source.malformed(parts.place.clone(), found, "finite numbers"));
        }
        if value != 0.0 {
            entries.push(((at % rows) as u32, (at / rows) as u32, value));
        }
    }
    Ok(entries)
}
