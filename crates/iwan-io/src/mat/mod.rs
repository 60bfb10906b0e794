//! MATLAB MAT-files: numeric arrays of all types, structs and cell arrays, nested, of level 5 (plain or compressed) and 7.3.
//!
//! Layout after "MAT-File Format", The MathWorks, chapter 1 (level 5). The reader is our own because the published crate cannot read
//! structs. A field is named by its path, `HIdata.time`; the elements of a struct array are numbered, counted from 1 as MATLAB does,
//! `hits(2).acc`.

mod element;
mod stored;
mod matrix;
mod hdf;

pub use stored::{StoredMatrix, StoredNumbers};

use crate::assembly::{Chooser, Raw, Variable, units};
use crate::bytes::Order;
use crate::error::ReadError;
use crate::file_bytes::FileBytes;
use crate::inflate::{most, read_limited, refused};
use crate::options::ReadOptions;
use crate::warning::Warning;
use element::{Cursor, ElementType};
use flate2::bufread::ZlibDecoder;
use iwan_machine::{is_harmful, plain};
use matrix::{Found, Reader, Said};
use std::path::Path;

/// Bytes before the first data element: 116 of text, 8 of offsets, version and byte order.
const HEADER: usize = 128;

/// Time and channels of a MAT-file.
pub(crate) fn parse(source: FileBytes, options: &ReadOptions) -> Result<Raw, ReadError> {
    let mut found = read(&source)?;
    found.refused.extend(found.matrices.iter().map(Said::no_channel));
    let asked =
        options.channels.iter().chain(&options.time).find(|n| found.refused.iter().any(|r| r.path == **n));
    if let Some(refused) = found.refused.iter().find(|r| Some(&r.path) == asked) {
        return Err(source.unsupported(
            &refused.path,
            &refused.text,
            "save real numeric arrays of one or two dimensions",
        ));
    }
    let left = |r: &Said| Warning::LeftOut { name: r.path.clone(), reason: format!("it is {}", r.text) };
    let warnings = found.refused.iter().map(left).collect();
    Chooser { source, options, tabular: false }.choose(with_units(found), warnings)
}

/// All matrices of a MAT-file of level 5 or 7.3, full and sparse, real and complex; `file` serves the messages only.
///
/// # Errors
/// [`ReadError`] where the file is not a MAT-file of level 5 or 7.3, or is damaged.
///
/// ```
/// let error = iwan_io::mat_matrices("k.mat".as_ref(), b"no MAT-file").unwrap_err();
/// assert!(error.to_string().starts_with("k.mat: header: found 11 bytes"));
/// ```
pub fn mat_matrices(file: &Path, bytes: &[u8]) -> Result<Vec<StoredMatrix>, ReadError> {
    let found = read(&FileBytes { file, bytes })?;
    let full = |v: Variable| StoredMatrix {
        name: v.name,
        rows: v.rows,
        columns: v.columns,
        numbers: StoredNumbers::Full(v.values),
        complex: false,
    };
    Ok(found.arrays.into_iter().map(full).chain(found.matrices).collect())
}

/// What a file of level 5 or 7.3 holds.
fn read(source: &FileBytes) -> Result<Found, ReadError> {
    let mut found = if is_level_7_3(source.bytes) { hdf::read(source)? } else { level_5(source)? };
    let Found { arrays, texts, refused, matrices } = &mut found;
    let names = arrays.iter_mut().map(|v| &mut v.name).chain(matrices.iter_mut().map(|m| &mut m.name));
    let paths = texts.iter_mut().chain(refused).map(|said| &mut said.path);
    names.chain(paths).filter(|name| name.contains(is_harmful)).for_each(|name| *name = plain(name));
    Ok(found)
}

/// Signature of HDF5, at the start or behind MATLAB's own header of 512 bytes.
const HDF5: &[u8] = b"\x89HDF\r\n\x1a\n";

fn is_level_7_3(bytes: &[u8]) -> bool {
    bytes.starts_with(HDF5) || bytes.starts_with(b"MATLAB 7.3") && bytes.get(512..520) == Some(HDF5)
}

/// What a level 5 file holds.
fn level_5(source: &FileBytes) -> Result<Found, ReadError> {
    let order = check_header(source)?;
    let mut found = Found::default();
    let mut cursor = Cursor::new(source, &source.bytes[HEADER..], order, HEADER);
    while let Some(element) = cursor.next()? {
        if element.kind != ElementType::Compressed {
            Reader { source, order }.top(&element, &mut found)?;
            continue;
        }
        let place = format!("compressed variable at byte {}", element.offset);
        let bytes = read_limited(&mut ZlibDecoder::new(element.data), most(element.data.len()))
            .map_err(|e| refused(source, &place, e, "zlib data"))?;
        let mut inside = Cursor::new(source, &bytes, order, 0);
        while let Some(inner) = inside.next()? {
            Reader { source, order }.top(&inner, &mut found)?;
        }
    }
    Ok(found)
}

/// Byte order of a file of level 5; other levels are refused by name.
fn check_header(source: &FileBytes) -> Result<Order, ReadError> {
    let bytes = source.bytes;
    let text = bytes.get(..HEADER).unwrap_or_default();
    let version = [text.get(124), text.get(125)];
    let order = match text.get(126..) {
        Some(b"IM") => Order::Little,
        Some(b"MI") => Order::Big,
        _ => return Err(not_level_5(source)),
    };
    let major = if order == Order::Little { version[1] } else { version[0] };
    if major == Some(&2) || text.starts_with(b"MATLAB 7.3") {
        return Err(level_7_3(source));
    }
    if major != Some(&1) {
        let found = format!("version {:?}", major.copied().unwrap_or_default());
        return Err(source.malformed("bytes 124 to 125", found, "version 1"));
    }
    Ok(order)
}

fn level_7_3(source: &FileBytes) -> ReadError {
    let remedy = "save or copy it again, or save it with save(..., '-v7')";
    source.unsupported(
        "header",
        "a MATLAB v7.3 file without the HDF5 part behind its first 512 bytes",
        remedy,
    )
}

fn not_level_5(source: &FileBytes) -> ReadError {
    if is_level_4(source.bytes) {
        let remedy = "save it again with save(..., '-v7'), or export CSV or NPZ";
        return source.unsupported("header", "a MATLAB v4 file", remedy);
    }
    let found = format!("{} bytes without the header of level 5", source.bytes.len());
    source.malformed("header", found, "128 bytes that end in IM or MI")
}

/// Whether the bytes are a MAT-file of level 4: it starts with the number MOPT of four decimal digits, the second of which is 0, then rows,
/// columns and a flag 0 or 1.
fn is_level_4(bytes: &[u8]) -> bool {
    let word = |i: usize, order| crate::bytes::u32_at(bytes, 4 * i, order);
    [Order::Little, Order::Big].into_iter().any(|order| {
        let mopt =
            word(0, order).is_some_and(|m| m < 5000 && m / 100 % 10 == 0 && m / 10 % 10 < 6 && m % 10 < 3);
        mopt && word(3, order).is_some_and(|flag| flag < 2)
            && word(4, order).is_some_and(|n| n > 0 && n < 256)
    })
}

/// Numeric arrays with their units. A text field `unit` or `units` beside or above an array states its unit; the text `s, m/s^2` states
/// first that of the time, then that of all others.
fn with_units(found: Found) -> Vec<Variable> {
    let mut variables = found.arrays;
    for Said { path, text } in &found.texts {
        if !matches!(units::base(path).as_str(), "unit" | "units") {
            continue;
        }
        let parent = path.rsplit_once('.').map_or("", |(parent, _)| parent);
        let (time, rest) = text.split_once(',').unwrap_or(("", text));
        let inside = |name: &str| match name.strip_prefix(parent) {
            Some(rest) if !parent.is_empty() => rest.starts_with('.'),
            _ => parent.is_empty() && !name.contains('.'),
        };
        for v in &mut variables {
            if inside(&v.name) {
                let unit = if units::is_time_name(&v.name) { time } else { rest };
                v.unit = unit.trim().into();
            }
        }
    }
    variables
}
