//! Measured and simulated records: CSV, LVM, NPY/NPZ, UFF 58/58b, MATLAB and WAV files; tables of results.
//!
//! [`read`] turns a file into a [`Record`]: uniformly sampled channels, checked once. [`Table`] writes columns of
//! results as CSV, NPZ or Parquet. [`atomic`] makes files appear whole or not at all.
//!
//! Text files are recognised by their extension, all others by their content. In a single column, a decimal comma cannot be told from a
//! separator: use a point.

// What a record is, what the user may say about a file before it is read, and what the reader says about the file afterwards.
mod quantity;
mod time_unit;
mod warning;
mod record;
mod error;
mod options;

// Bytes: a file in memory that names itself in every error, numbers of all types, decompression that is bounded in size.
mod file_bytes;
mod bytes;
mod inflate;

// From named arrays to a record.
mod assembly;

// One module for each format that is read, and the entry points common to all formats.
mod text;
mod numpy;
mod uff;
mod mat;
mod lvm;
mod wav;
mod door;

// Files that are written.
pub mod atomic;
mod table;

pub use assembly::{quantity_of_unit, unit_of_times};
pub use bytes::{NumberType, Order};
pub use door::{MeasuredChannel, Measurement, ModalTest, read, read_bytes, read_modal_test};
pub use error::ReadError;
pub use mat::{StoredMatrix, StoredNumbers, mat_matrices};
pub use numpy::{NPY_MAGIC, NumpyArray, numpy_members};
pub use options::{Format, ReadOptions};
pub use quantity::Quantity;
pub use record::{Record, RecordError};
pub use table::{Growing, GrowingError, Table, TableError};
pub use text::{Columns, parse_table, read_table};
pub use time_unit::{TimeUnit, UnknownTimeUnit};
pub use uff::{
    NodalDirection, ROD, UffFunction, UffModel, functions as uff_functions, model as uff_model,
    write as write_uff,
};
pub use warning::Warning;
