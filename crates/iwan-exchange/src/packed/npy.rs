//! A dense matrix in a NumPy array; iwan-io reads the array.

use iwan_io::NumpyArray;

use super::translated;
use crate::error::ExchangeError;
use crate::matrix::{Matrix, Stored};
use crate::source::{MOST_ROWS, Source};

/// The array in `bytes`; messages call it `name`.
pub(crate) fn array<'a>(
    source: &Source,
    bytes: &'a [u8],
    name: &str,
) -> Result<NumpyArray<'a>, ExchangeError> {
    NumpyArray::read(source.file, bytes, name).map_err(|error| translated(source, error))
}

/// A dense matrix in an NPY file.
pub(crate) fn parse(source: &Source) -> Result<Vec<Matrix>, ExchangeError> {
    let array = array(source, source.bytes, "the file")?;
    Ok(vec![dense(source, &array, String::new())?])
}

/// The matrix in an array of two dimensions.
pub(super) fn dense(source: &Source, array: &NumpyArray, name: String) -> Result<Matrix, ExchangeError> {
    let place = || format!("array '{name}'");
    let [rows, columns] = array.shape[..] else {
        let found = format!("an array of {} dimensions", array.shape.len());
        return Err(source.unsupported(place(), found, "save a matrix of two dimensions"));
    };
    if rows as u64 > MOST_ROWS || columns as u64 > MOST_ROWS || array.letters().is_some() {
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
