//! An NPY file as a record: one array, whose first column (or row) may be the time.

use super::array::NumpyArray;
use crate::assembly::{Chooser, Raw, Variable};
use crate::error::ReadError;
use crate::file_bytes::FileBytes;
use crate::options::ReadOptions;

/// Time and channels of an NPY file.
pub(crate) fn parse(source: FileBytes, options: &ReadOptions) -> Result<Raw, ReadError> {
    let name = source.file.file_stem().map_or("array".into(), |s| s.to_string_lossy().into_owned());
    let array = variable(&source, source.bytes, &name)?;
    Chooser { source, options, tabular: true }.choose(vec![array], Vec::new())
}

/// The array in `bytes`; `name` serves the result and the messages.
pub(super) fn variable(source: &FileBytes, bytes: &[u8], name: &str) -> Result<Variable, ReadError> {
    let array = NumpyArray::read(source.file, bytes, name)?;
    let (rows, columns) = match array.shape[..] {
        [] => (1, 1),
        [n] => (n, 1),
        [rows, columns] => (rows, columns),
        _ => {
            let found = format!("an array of {} dimensions", array.shape.len());
            let place = format!("array '{name}', key 'shape'");
            let remedy = "save arrays of one or two dimensions: of several hits each in a file of its own, samples in rows and channels in columns";
            return Err(source.unsupported(place, found, remedy));
        }
    };
    let values = array.numbers(source, name)?;
    // An empty array may state any number of columns with no rows: it is taken as an empty vector.
    let (rows, columns) = if values.is_empty() { (0, 1) } else { (rows, columns) };
    let values =
        if array.fortran || rows == 1 || columns == 1 { values } else { transpose(&values, columns) };
    Ok(Variable { name: name.into(), unit: String::new(), rows, columns, values })
}

/// Values in rows, one row after the other, reordered to one column after the other.
fn transpose(values: &[f64], columns: usize) -> Vec<f64> {
    (0..columns).flat_map(|c| values.iter().skip(c).step_by(columns).copied()).collect()
}
