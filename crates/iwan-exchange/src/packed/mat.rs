//! MATLAB: sparse and full matrices of MAT-files of level 5 and 7.3; iwan-io reads the file.

use iwan_io::{StoredMatrix, StoredNumbers, mat_matrices};

use super::translated;
use crate::error::ExchangeError;
use crate::matrix::{Entry, Matrix, Stored};
use crate::source::{MOST_ROWS, Source};

pub(crate) fn parse(source: &Source) -> Result<Vec<Matrix>, ExchangeError> {
    let stored = mat_matrices(source.file, source.bytes).map_err(|error| translated(source, error))?;
    let matrices: Vec<Matrix> =
        stored.into_iter().map(|matrix| checked(source, matrix)).collect::<Result<_, _>>()?;
    if matrices.is_empty() {
        Err(source.ends("a variable that is a matrix of numbers"))
    } else {
        Ok(matrices)
    }
}

/// The matrix with its entries; an error where an entry lies outside it or is not finite.
fn checked(source: &Source, stored: StoredMatrix) -> Result<Matrix, ExchangeError> {
    let StoredMatrix { name, rows, columns, numbers, complex } = stored;
    if rows as u64 > MOST_ROWS || columns as u64 > MOST_ROWS {
        let (found, expected) = (format!("{rows} x {columns}"), format!("at most {MOST_ROWS} rows"));
        return Err(source.malformed(format!("variable '{name}'"), found, expected));
    }
    let bad =
        |found: String, expected: String| source.malformed(format!("variable '{name}'"), found, expected);
    let entries = match numbers {
        StoredNumbers::Full(values) => full(&values, rows, bad)?,
        StoredNumbers::Sparse { rows: indices, starts, values } => {
            sparse(&indices, &starts, &values, [rows, columns], bad)?
        }
    };
    Ok(Matrix { name, rows, columns, entries, stored: Stored::All, labels: None, complex })
}

/// Entries of a sparse matrix from row indices, starts of columns and values.
fn sparse(
    indices: &[f64],
    starts: &[f64],
    values: &[f64],
    [rows, columns]: [usize; 2],
    bad: impl Fn(String, String) -> ExchangeError,
) -> Result<Vec<Entry>, ExchangeError> {
    if starts.len() != columns + 1 {
        return Err(bad(format!("{} column starts", starts.len()), format!("{}", columns + 1)));
    }
    let (mut entries, mut from) = (Vec::new(), 0);
    let count = indices.len().min(values.len());
    for (column, &start) in starts[1..].iter().enumerate() {
        if !(from as f64..=count as f64).contains(&start) {
            let found = format!("start {start} of column {}", column + 2);
            return Err(bad(found, format!("{from} to {count}")));
        }
        let to = start as usize;
        for (&row, &value) in indices[from..to].iter().zip(&values[from..to]) {
            if !((0.0..rows as f64).contains(&row) && value.is_finite()) {
                let found = format!("row {} with value {value} in column {}", row + 1.0, column + 1);
                return Err(bad(found, format!("a row from 1 to {rows} and a finite number")));
            }
            entries.push((row as u32, column as u32, value));
        }
        from = to;
    }
    Ok(entries)
}

/// Entries of a full matrix, stored column after column.
fn full(
    values: &[f64],
    rows: usize,
    bad: impl Fn(String, String) -> ExchangeError,
) -> Result<Vec<Entry>, ExchangeError> {
    let mut entries = Vec::new();
    for (at, &value) in values.iter().enumerate() {
        let (row, column) = (at % rows, at / rows);
        if !value.is_finite() {
            return Err(bad(
                format!("{value} in row {}, column {}", row + 1, column + 1),
                "finite numbers".into(),
            ));
        }
        if value != 0.0 {
            entries.push((row as u32, column as u32, value));
        }
    }
    Ok(entries)
}
