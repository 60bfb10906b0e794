//! Sparse matrices as `scipy.sparse.save_npz` writes them: CSR, CSC and COO; and dense arrays in an archive.

use std::collections::BTreeMap;

use iwan_io::{NumpyArray, numpy_members};

use iwan_machine::shortened;

use super::npy::{array, dense};
use super::translated;
use crate::error::ExchangeError;
use crate::matrix::{Entry, Matrix, Stored};
use crate::source::{MOST_ROWS, Source};

/// Arrays of which `scipy.sparse.save_npz` makes a matrix.
const SPARSE: [&str; 9] =
    ["format", "shape", "data", "indices", "indptr", "row", "col", "coords", "_is_array"];

/// All members of the archive: name and bytes.
pub(crate) fn members(source: &Source) -> Result<BTreeMap<String, Vec<u8>>, ExchangeError> {
    numpy_members(source.file, source.bytes).map_err(|error| translated(source, error))
}

/// The arrays that make up one matrix.
struct Parts<'s, 'a> {
    source: &'s Source<'a>,
    arrays: BTreeMap<&'s str, NumpyArray<'s>>,
}

impl Parts<'_, '_> {
    fn get(&self, name: &str) -> Result<&NumpyArray<'_>, ExchangeError> {
        self.arrays.get(name).ok_or_else(|| {
            let found = format!("no array '{name}'");
            self.source.malformed("the archive", found, "what scipy.sparse.save_npz writes")
        })
    }

    /// Entry `at` of the array `name`, which must be a whole number from 0 to `most` - 1.
    fn index(&self, name: &str, at: usize, most: usize) -> Result<usize, ExchangeError> {
        let value = self.get(name)?.at(at).unwrap_or(f64::NAN);
        if value >= 0.0 && value.fract() == 0.0 && value < most as f64 {
            return Ok(value as usize);
        }
        let place = format!("array '{name}', entry {}", at + 1);
        Err(self.source.malformed(
            place,
            value.to_string(),
            format!("a whole number from 0 to {}", most.max(1) - 1),
        ))
    }

    fn value(&self, at: usize) -> Result<f64, ExchangeError> {
        let value = self.get("data")?.at(at).unwrap_or(f64::NAN);
        if value.is_finite() {
            return Ok(value);
        }
        Err(self.source.malformed(
            format!("array 'data', entry {}", at + 1),
            value.to_string(),
            "a finite number",
        ))
    }

    fn same_length(&self, name: &str, count: usize) -> Result<(), ExchangeError> {
        let length = self.get(name)?.len();
        if length == count {
            return Ok(());
        }
        let found = format!("{length} entries");
        Err(self.source.malformed(format!("array '{name}'"), found, format!("{count}")))
    }
}

pub(crate) fn parse(source: &Source) -> Result<Vec<Matrix>, ExchangeError> {
    let members = members(source)?;
    let mut parts = Parts { source, arrays: BTreeMap::new() };
    for (name, bytes) in &members {
        parts.arrays.insert(name, array(source, bytes, name)?);
    }
    if !parts.arrays.contains_key("format") {
        return parts.arrays.iter().map(|(name, array)| dense(source, array, (*name).into())).collect();
    }
    if let Some(other) = parts.arrays.keys().find(|name| !SPARSE.contains(*name)) {
        let found = format!("a sparse matrix and beside it the array '{}'", shortened(other, 60));
        return Err(source.unsupported(
            "the archive",
            found,
            "save each matrix in a file of its own with scipy.sparse.save_npz",
        ));
    }
    let format = parts.get("format")?.letters().unwrap_or_default();
    let shape = [0, 1].map(|at| parts.index("shape", at, MOST_ROWS as usize + 1));
    let [rows, columns] = [shape[0].as_ref(), shape[1].as_ref()].map(|n| n.copied().unwrap_or(0));
    if let [Err(error), _] | [_, Err(error)] = shape {
        return Err(error);
    }
    let entries = match format.as_str() {
        "csr" => compressed(&parts, [rows, columns], false)?,
        "csc" => compressed(&parts, [rows, columns], true)?,
        "coo" => coordinates(&parts, [rows, columns])?,
        other => {
            let found = format!("a matrix of the kind {other}");
            return Err(source.unsupported(
                "array 'format'",
                found,
                "save it with scipy.sparse.save_npz as .tocsr()",
            ));
        }
    };
    Ok(vec![Matrix {
        name: String::new(),
        rows,
        columns,
        entries,
        stored: Stored::All,
        labels: None,
        complex: false,
    }])
}

/// Entries of a matrix in compressed rows (CSR), or in compressed columns (CSC) when `by_column`.
fn compressed(
    parts: &Parts,
    [rows, columns]: [usize; 2],
    by_column: bool,
) -> Result<Vec<Entry>, ExchangeError> {
    let (outer, inner) = if by_column { (columns, rows) } else { (rows, columns) };
    let count = parts.get("data")?.len();
    parts.same_length("indices", count)?;
    parts.same_length("indptr", outer + 1)?;
    let (mut entries, mut from) = (Vec::new(), parts.index("indptr", 0, 1)?);
    for line in 0..outer {
        let to = parts.index("indptr", line + 1, count + 1)?;
        if to < from || (line + 1 == outer && to != count) {
            let place = format!("array 'indptr', entry {}", line + 2);
            return Err(parts.source.malformed(
                place,
                to.to_string(),
                format!("a number from {from} to {count}"),
            ));
        }
        for at in from..to {
            let other = parts.index("indices", at, inner)? as u32;
            let (i, j) = if by_column { (other, line as u32) } else { (line as u32, other) };
            entries.push((i, j, parts.value(at)?));
        }
        from = to;
    }
    Ok(entries)
}

fn coordinates(parts: &Parts, [rows, columns]: [usize; 2]) -> Result<Vec<Entry>, ExchangeError> {
    let count = parts.get("data")?.len();
    // SciPy 1.13 and later store row and column indices in one array `coords`.
    if parts.arrays.contains_key("coords") {
        parts.same_length("coords", 2 * count)?;
        let entry = |at| {
            let (i, j) = (parts.index("coords", at, rows)?, parts.index("coords", count + at, columns)?);
            Ok((i as u32, j as u32, parts.value(at)?))
        };
        return (0..count).map(entry).collect();
    }
    parts.same_length("row", count)?;
    parts.same_length("col", count)?;
    let entry = |at| {
        Ok((parts.index("row", at, rows)? as u32, parts.index("col", at, columns)? as u32, parts.value(at)?))
    };
    (0..count).map(entry).collect()
}
