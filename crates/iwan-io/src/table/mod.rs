//! Tables of results as CSV, NPZ and Parquet.

mod names;
mod lines;
mod archive;
mod parquet_file;
mod growing;

pub use growing::{Growing, GrowingError};
pub use names::TableError;

use crate::atomic::{WriteError, write_file};
use archive::{bytes, entry};
use lines::{csv_header, csv_rows};
use names::check_names;
use std::io::{self, Seek, Write};
use std::path::Path;

/// Number of values that are turned into bytes at once, 32 KiB, so that no second copy of a column is made.
const CHUNK: usize = 1 << 12;

/// Named columns of equal length, borrowed for writing. NaN and infinite values are written as they are.
///
/// ```
/// let (t, u) = ([0.0, 0.5], [0.1, -1e-20]);
/// let table = iwan_io::Table::new(vec![("t".into(), &t[..]), ("tip.displacement".into(), &u[..])])?;
/// let mut text = Vec::new();
/// table.csv_to(&mut text)?;
/// assert_eq!(text, b"t,tip.displacement\n0.0,0.1\n0.5,-1e-20\n");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Table<'a> {
    columns: Vec<(String, &'a [f64])>,
}

impl<'a> Table<'a> {
    /// Checks the columns and makes a table of them.
    ///
    /// # Errors
    /// [`TableError`] names the column.
    pub fn new(columns: Vec<(String, &'a [f64])>) -> Result<Self, TableError> {
        let Some((_, first)) = columns.first() else { return Err(TableError::Empty) };
        for (name, values) in &columns {
            let (rows, expected) = (values.len(), first.len());
            if rows != expected {
                return Err(TableError::Lengths { name: name.clone(), rows, expected });
            }
        }
        check_names(columns.iter().map(|(name, _)| name))?;
        Ok(Self { columns })
    }

    /// Names and values of the columns.
    #[must_use]
    pub fn columns(&self) -> &[(String, &'a [f64])] {
        &self.columns
    }

    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.columns[0].1.len()
    }

    /// Writes CSV (RFC 4180, lines end in LF) with the shortest decimals that give the same f64 back.
    ///
    /// # Errors
    /// What the sink reports.
    pub fn csv_to(&self, mut sink: impl Write) -> io::Result<()> {
        sink.write_all(&csv_header(self.columns.iter().map(|(name, _)| name))?)?;
        let columns: Vec<&[f64]> = self.columns.iter().map(|(_, values)| *values).collect();
        csv_rows(&columns, &mut sink)
    }

    /// Writes NPZ: one float64 array for each column, not compressed, for `numpy.load`.
    ///
    /// # Errors
    /// What the sink reports.
    pub fn npz_to(&self, sink: impl Write + Seek) -> io::Result<()> {
        let mut archive = zip::ZipWriter::new(sink);
        for (name, values) in &self.columns {
            entry(&mut archive, name, values.len())?;
            values.chunks(CHUNK).try_for_each(|chunk| archive.write_all(&bytes(chunk)))?;
        }
        archive.finish()?;
        Ok(())
    }

    /// Writes Parquet: one required DOUBLE column for each column, plain encoding, not compressed.
    ///
    /// # Errors
    /// What the sink or the Parquet library reports.
    pub fn parquet_to(&self, sink: impl Write + Send) -> io::Result<()> {
        parquet_file::write(&self.columns, sink).map_err(io::Error::other)
    }

    /// [`Table::csv_to`] a file that appears whole or not at all.
    ///
    /// # Errors
    /// [`WriteError`] names the path and what helps.
    pub fn write_csv(&self, path: impl AsRef<Path>, force: bool) -> Result<(), WriteError> {
        write_file(path, force, |w| self.csv_to(w))
    }

    /// [`Table::npz_to`] a file that appears whole or not at all.
    ///
    /// # Errors
    /// [`WriteError`] names the path and what helps.
    pub fn write_npz(&self, path: impl AsRef<Path>, force: bool) -> Result<(), WriteError> {
        write_file(path, force, |w| self.npz_to(w))
    }

    /// [`Table::parquet_to`] a file that appears whole or not at all.
    ///
    /// # Errors
    /// [`WriteError`] names the path and what helps.
    pub fn write_parquet(&self, path: impl AsRef<Path>, force: bool) -> Result<(), WriteError> {
        write_file(path, force, |w| self.parquet_to(w))
    }
}
