//! Named columns of a file (text, MATLAB, NumPy), or the frequency responses of a universal file.

use std::path::Path;

use iwan_io::{Format, ReadError, ReadOptions, UffFunction, read_modal_test, read_table};

use crate::failure::Failure;
use crate::shown;

/// Content of a file: columns of equal length by name, or frequency responses.
#[derive(Debug)]
pub(crate) enum Content {
    Columns(Vec<(String, Vec<f64>)>),
    Responses(Vec<UffFunction>),
}

/// Reads a file.
pub(crate) fn read(path: &Path) -> Result<Content, Failure> {
    let refused = |error: ReadError| Failure::read(&shown::path(path), &error);
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_lowercase();
    if matches!(extension.as_str(), "csv" | "tsv" | "txt" | "dat" | "asc") {
        let table = read_table(path).map_err(refused)?;
        let columns = table.names().iter().cloned().zip(table.columns().iter().cloned());
        return Ok(Content::Columns(columns.collect()));
    }
    if matches!(extension.as_str(), "uff" | "unv" | "uf" | "bunv") {
        let options = ReadOptions { format: Some(Format::Uff), ..ReadOptions::default() };
        return Ok(Content::Responses(read_modal_test(path, &options).map_err(refused)?.responses));
    }
    // Arrays of equal length are read as columns; a given rate makes the reader look for no time vector among them.
    let options = ReadOptions { rate: Some(1.0), ..ReadOptions::default() };
    let test = read_modal_test(path, &options).map_err(refused)?;
    let channels = test.measurements.into_iter().flat_map(|m| m.channels);
    // A field of a struct is called by the last part of its name.
    let own = |name: String| name.rsplit('.').next().unwrap_or_default().to_string();
    Ok(Content::Columns(channels.map(|c| (own(c.name), c.samples)).collect()))
}
