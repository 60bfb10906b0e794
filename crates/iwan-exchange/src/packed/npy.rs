//! One NumPy array, format versions 1 to 3 (`numpy.lib.format`).

use super::numbers::{Class, Kind};
use crate::error::ExchangeError;
use crate::matrix::{Matrix, Stored};
use crate::source::{MOST_ROWS, Source, quote};

/// Start of every NPY file.
pub(crate) const MAGIC: &[u8] = b"\x93NUMPY";

/// An array.
pub(crate) struct Array<'a> {
    kind: Kind,
    /// The array holds text or bytes.
    pub(crate) text: bool,
    pub(crate) shape: Vec<usize>,
    pub(crate) fortran: bool,
    pub(super) data: &'a [u8],
}

impl<'a> Array<'a> {
    /// The array in `bytes`, called `name` in messages.
    pub(crate) fn read(source: &Source, bytes: &'a [u8], name: &str) -> Result<Self, ExchangeError> {
        let place = || format!("array '{name}'");
        let (head, data) = split(bytes).ok_or_else(|| {
            source.malformed(
                place(),
                "no complete NPY header",
                "the magic string, version 1 to 3, and the header",
            )
        })?;
        let head = String::from_utf8_lossy(head);
        let bad = |expected: &str| source.malformed(place(), quote(head.trim().as_bytes(), 120), expected);
        let descr =
            value(&head, "descr").and_then(quoted).ok_or_else(|| bad("'descr': a type such as '<f8'"))?;
        let (kind, text) = kind(descr).ok_or_else(|| {
            source.unsupported(
                place(),
                format!("type '{descr}'"),
                "save float32 or float64, integers of up to 64 bits",
            )
        })?;
        let fortran = value(&head, "fortran_order").is_some_and(|v| v.trim_start().starts_with("True"));
        let shape = value(&head, "shape").and_then(shape).ok_or_else(|| bad("'shape': a tuple of sizes"))?;
        let count = shape.iter().try_fold(kind.size, |product, n| product.checked_mul(*n));
        let data = count.and_then(|count| data.get(..count)).ok_or_else(|| {
            let found = format!("{} bytes for the shape {shape:?}", data.len());
            source.malformed(place(), found, "as many bytes as the shape says")
        })?;
        Ok(Self { kind, text, shape, fortran, data })
    }

    /// Number `at` in the order of the file.
    pub(crate) fn at(&self, at: usize) -> Option<f64> {
        self.kind.at(self.data, at)
    }

    pub(crate) fn len(&self) -> usize {
        self.kind.count(self.data)
    }
}

/// A dense matrix in an NPY file.
pub(crate) fn parse(source: &Source) -> Result<Vec<Matrix>, ExchangeError> {
    let array = Array::read(source, source.bytes, "the file")?;
    Ok(vec![dense(source, &array, String::new())?])
}

/// A dense matrix.
pub(super) fn dense(source: &Source, array: &Array, name: String) -> Result<Matrix, ExchangeError> {
    let place = || format!("array '{name}'");
    let [rows, columns] = array.shape[..] else {
        let found = format!("an array of {} dimensions", array.shape.len());
        return Err(source.unsupported(place(), found, "save a matrix of two dimensions"));
    };
    if rows as u64 > MOST_ROWS || columns as u64 > MOST_ROWS || array.text {
        return Err(source.unsupported(
            place(),
            format!("the shape {:?}", array.shape),
            "save a matrix of numbers",
        ));
    }
    let mut entries = Vec::new();
    for at in 0..array.len() {
        let (i, j) = if array.fortran { (at % rows, at / rows) } else { (at / columns, at % columns) };
        let value = array.at(at).unwrap_or(f64::NAN);
        if !value.is_finite() {
            let found = format!("{value} in row {}, column {}", i + 1, j + 1);
            return Err(source.malformed(place(), found, "finite numbers"));
        }
        if value != 0.0 {
            entries.push((i as u32, j as u32, value));
        }
    }
    Ok(Matrix { name, rows, columns, entries, stored: Stored::All, labels: None, complex: false })
}

/// Dictionary and data.
fn split(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let rest = bytes.strip_prefix(MAGIC)?;
    let (length, start) = match rest.first()? {
        1 => (usize::from(u16::from_le_bytes([*rest.get(2)?, *rest.get(3)?])), 4),
        2 | 3 => (u32::from_le_bytes(*rest.get(2..)?.first_chunk()?) as usize, 6),
        _ => return None,
    };
    let rest = rest.get(start..)?;
    Some((rest.get(..length)?, &rest[length..]))
}

/// What follows `'key':` in the dictionary.
fn value<'a>(text: &'a str, key: &str) -> Option<&'a str> {
    let at = text.find(&format!("'{key}'"))? + key.len() + 2;
    text[at..].trim_start().strip_prefix(':')
}

fn quoted(text: &str) -> Option<&str> {
    text.trim_start().strip_prefix('\'')?.split('\'').next()
}

/// NumPy's own limit of dimensions up to version 1.
const MOST_DIMENSIONS: usize = 32;

fn shape(text: &str) -> Option<Vec<usize>> {
    let (inside, _) = text.trim_start().strip_prefix('(')?.split_once(')')?;
    let sizes = inside.split(',').map(|s| s.trim().trim_end_matches('L')).filter(|s| !s.is_empty());
    sizes.take(MOST_DIMENSIONS).map(|s| s.parse().ok()).collect()
}

/// Type by its name in NumPy, and whether it is text.
fn kind(descr: &str) -> Option<(Kind, bool)> {
    let (order, rest) = descr.split_at_checked(1)?;
    let (class, size) = rest.split_at_checked(1)?;
    let size: usize = size.parse().ok()?;
    let big = order == ">";
    let class = match (class, size) {
        ("f", 4 | 8) => Class::Float,
        ("i", 1 | 2 | 4 | 8) => Class::Signed,
        ("u" | "b", 1 | 2 | 4 | 8) => Class::Unsigned,
        ("S", 1..=64) => return Some((Kind { size, class: Class::Unsigned, big: false }, true)),
        ("U", 1..=64) => return Some((Kind { size: 4 * size, class: Class::Unsigned, big: false }, true)),
        _ => return None,
    };
    Some((Kind { size, class, big }, false))
}
