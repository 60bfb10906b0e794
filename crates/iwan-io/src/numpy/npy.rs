//! One NumPy array, format versions 1 to 3 (NumPy Enhancement Proposal 1, `numpy.lib.format`).
//!
//! Own reader of some lines: the published ones allocate what a header promises and parse its dictionary with a
//! general Python parser that needs a C tool chain; a damaged header must neither exhaust memory nor panic here.

use crate::assembly::{Chooser, Raw, Variable};
use crate::bytes::{NumberType, Order, to_f64};
use crate::error::ReadError;
use crate::file_bytes::{FileBytes, decode, shorten};
use crate::options::ReadOptions;

/// Start of every NPY file.
pub(crate) const MAGIC: &[u8] = b"\x93NUMPY";

/// NumPy's own limit up to version 1; arrays of more than two dimensions are refused anyway, with their number.
const MOST_DIMENSIONS: usize = 32;

struct Header {
    kind: NumberType,
    order: Order,
    fortran: bool,
    rows: usize,
    columns: usize,
}

/// Time and channels of an NPY file: one array, whose first column (or row) may be the time.
pub(crate) fn parse(source: FileBytes, options: &ReadOptions) -> Result<Raw, ReadError> {
    let name = source.file.file_stem().map_or("array".into(), |s| s.to_string_lossy().into_owned());
    let array = array(&source, source.bytes, &name)?;
    Chooser { source, options, tabular: true }.choose(vec![array], Vec::new())
}

/// The array in `bytes`; `name` serves the result and the messages.
pub(crate) fn array(source: &FileBytes, bytes: &[u8], name: &str) -> Result<Variable, ReadError> {
    let (text, data) = split(bytes).ok_or_else(|| {
        let found = "no complete NPY header".to_string();
        source.malformed(format!("array '{name}'"), found, "the magic string, version 1 to 3, and the header")
    })?;
    let header = header(source, &decode(text), name)?;
    let count = header.rows.checked_mul(header.columns);
    let promised = count.and_then(|c| c.checked_mul(header.kind.size()));
    let Some(data) = promised.and_then(|n| data.get(..n)) else {
        let promised = promised.map_or(u64::MAX, |p| p as u64);
        return Err(source.cut_short(format!("array '{name}'"), "bytes", promised, data.len() as u64));
    };
    let values = to_f64(data, header.kind, header.order);
    // An array of nothing may say that it has any number of columns of no rows: it is an empty vector.
    let (rows, columns) = if values.is_empty() { (0, 1) } else { (header.rows, header.columns) };
    let values =
        if header.fortran || rows == 1 || columns == 1 { values } else { transpose(&values, columns) };
    Ok(Variable { name: name.into(), unit: String::new(), rows, columns, values })
}

/// Row after row to column after column.
fn transpose(values: &[f64], columns: usize) -> Vec<f64> {
    (0..columns).flat_map(|c| values.iter().skip(c).step_by(columns).copied()).collect()
}

/// Dictionary and data.
fn split(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let rest = bytes.strip_prefix(MAGIC)?;
    let (length, start) = match rest.first()? {
        1 => (usize::from(u16::from_le_bytes([*rest.get(2)?, *rest.get(3)?])), 4),
        2 | 3 => {
            let raw = [*rest.get(2)?, *rest.get(3)?, *rest.get(4)?, *rest.get(5)?];
            (usize::try_from(u32::from_le_bytes(raw)).ok()?, 6)
        }
        _ => return None,
    };
    let rest = &rest[start..];
    Some((rest.get(..length)?, &rest[length..]))
}

fn header(source: &FileBytes, text: &str, name: &str) -> Result<Header, ReadError> {
    let place = |key: &str| format!("array '{name}', key '{key}'");
    let bad = |key: &str, expected: &str| source.malformed(place(key), shorten(text.trim(), 120), expected);
    let descr = value(text, "descr").ok_or_else(|| bad("descr", "a type such as '<f8'"))?;
    let descr = quoted(descr).unwrap_or(descr.trim_start());
    let Some((kind, order)) = kind(descr) else {
        let found = format!("type '{}'", shorten(descr, 40));
        let remedy = "save real numbers: float32, float64 or integers of up to 64 bits";
        return Err(source.unsupported(place("descr"), found, remedy));
    };
    let fortran = value(text, "fortran_order").map(str::trim_start);
    let fortran = match fortran {
        Some(v) if v.starts_with("True") => true,
        Some(v) if v.starts_with("False") => false,
        _ => return Err(bad("fortran_order", "True or False")),
    };
    let shape = value(text, "shape").and_then(shape).ok_or_else(|| bad("shape", "a tuple of sizes"))?;
    let (rows, columns) = match shape[..] {
        [] => (1, 1),
        [n] => (n, 1),
        [rows, columns] => (rows, columns),
        _ => {
            let found = format!("an array of {} dimensions", shape.len());
            return Err(source.unsupported(place("shape"), found, "save arrays of one or two dimensions"));
        }
    };
    Ok(Header { kind, order, fortran, rows, columns })
}

/// What follows `'key':` in the dictionary.
fn value<'a>(text: &'a str, key: &str) -> Option<&'a str> {
    let at = [format!("'{key}'"), format!("\"{key}\"")].iter().find_map(|k| Some(text.find(k)? + k.len()))?;
    text[at..].trim_start().strip_prefix(':')
}

fn quoted(text: &str) -> Option<&str> {
    let text = text.trim_start();
    let quote = text.chars().next().filter(|c| matches!(c, '\'' | '"'))?;
    text[1..].split(quote).next()
}

fn shape(text: &str) -> Option<Vec<usize>> {
    let (inside, _) = text.trim_start().strip_prefix('(')?.split_once(')')?;
    let sizes = inside.split(',').map(|s| s.trim().trim_end_matches('L')).filter(|s| !s.is_empty());
    sizes.take(MOST_DIMENSIONS + 1).map(|s| s.parse().ok()).collect()
}

fn kind(descr: &str) -> Option<(NumberType, Order)> {
    let (order, name) = match descr.as_bytes().first()? {
        b'>' => (Order::Big, &descr[1..]),
        b'<' | b'|' | b'=' => (Order::Little, &descr[1..]),
        _ => (Order::Little, descr),
    };
    let kind = match name {
        "f8" => NumberType::F64,
        "f4" => NumberType::F32,
        "i1" => NumberType::I8,
        "u1" | "b1" => NumberType::U8,
        "i2" => NumberType::I16,
        "u2" => NumberType::U16,
        "i4" => NumberType::I32,
        "u4" => NumberType::U32,
        "i8" => NumberType::I64,
        "u8" => NumberType::U64,
        _ => return None,
    };
    Some((kind, order))
}
