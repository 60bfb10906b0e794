//! Tables of results as CSV, NPZ and Parquet.

mod parquet_file;

use crate::atomic::{WriteError, write_file};
use std::borrow::Cow;
use std::collections::HashSet;
use std::io::{self, Seek, Write};
use std::path::Path;
use zip::write::SimpleFileOptions;

/// Values from which on an entry is written with 64-bit sizes: 2 GiB, half of what 32-bit sizes can tell, so that the header
/// of the array has room.
const ZIP32: usize = 1 << 28;
/// Values that are turned into bytes at once, 32 KiB, so that no second copy of a column is made.
const CHUNK: usize = 1 << 12;

/// Why columns do not make a [`Table`].
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TableError {
    /// No column at all.
    #[error("the table has no column; it needs at least one")]
    Empty,
    /// Columns of different lengths.
    #[error("column '{name}' has {rows} rows, the first column has {expected}; all must be equally long")]
    Lengths {
        /// Name of the column.
        name: String,
        /// Its number of rows.
        rows: usize,
        /// Number of rows of the first column.
        expected: usize,
    },
    /// The same name twice, an empty name, or one with a line break or zero byte.
    #[error(
        "column {index} (counted from 0) is called '{name}'; names must be unique, not empty, and without control characters"
    )]
    Name {
        /// Index of the column, counted from 0.
        index: usize,
        /// Its name.
        name: String,
    },
}

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

/// A name as spreadsheets show it: one that begins like a formula is told to be text by an apostrophe, as they do themselves (OWASP, "CSV
/// injection").
fn as_text(name: &str) -> Cow<'_, str> {
    if name.starts_with(['=', '+', '-', '@']) { format!("'{name}").into() } else { name.into() }
}

impl<'a> Table<'a> {
    /// Checks and keeps the columns.
    ///
    /// # Errors
    /// [`TableError`] names the column.
    pub fn new(columns: Vec<(String, &'a [f64])>) -> Result<Self, TableError> {
        let Some((_, first)) = columns.first() else { return Err(TableError::Empty) };
        let mut names = HashSet::with_capacity(columns.len());
        for (index, (name, values)) in columns.iter().enumerate() {
            let (rows, expected) = (values.len(), first.len());
            if rows != expected {
                return Err(TableError::Lengths { name: name.clone(), rows, expected });
            }
            let twice = !names.insert(name);
            if twice || name.is_empty() || name.chars().any(char::is_control) {
                return Err(TableError::Name { index, name: name.clone() });
            }
        }
        Ok(Self { columns })
    }

    /// Names and values.
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
        let mut header = csv::Writer::from_writer(Vec::new());
        header
            .write_record(self.columns.iter().map(|(name, _)| as_text(name).into_owned()))
            .map_err(io::Error::other)?;
        sink.write_all(&header.into_inner().map_err(|e| io::Error::other(e.to_string()))?)?;
        let (mut number, mut line) = (ryu::Buffer::new(), Vec::new());
        for row in 0..self.rows() {
            line.clear();
            for (_, values) in &self.columns {
                line.extend_from_slice(number.format(values[row]).as_bytes());
                line.push(b',');
            }
            line.pop();
            line.push(b'\n');
            sink.write_all(&line)?;
        }
        Ok(())
    }

    /// Writes NPZ: one float64 array for each column, not compressed, for `numpy.load`.
    ///
    /// # Errors
    /// What the sink reports.
    pub fn npz_to(&self, sink: impl Write + Seek) -> io::Result<()> {
        let mut archive = zip::ZipWriter::new(sink);
        let stored = SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
        for (name, values) in &self.columns {
            let large = values.len() > ZIP32;
            archive.start_file(format!("{name}.npy"), stored.large_file(large))?;
            archive.write_all(&npy_header(values.len()))?;
            for chunk in values.chunks(CHUNK) {
                archive.write_all(&chunk.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>())?;
            }
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

/// Header of a one-dimensional float64 array, version 1, padded so that the data start at a multiple of 64 bytes.
fn npy_header(rows: usize) -> Vec<u8> {
    let mut text = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({rows},), }}");
    let length = (10 + text.len() + 1).next_multiple_of(64) - 10;
    text.push_str(&" ".repeat(length - 1 - text.len()));
    text.push('\n');
    let mut header = crate::numpy::MAGIC.to_vec();
    header.extend([1, 0]);
    header.extend(u16::try_from(length).unwrap_or(118).to_le_bytes());
    header.extend(text.bytes());
    header
}
