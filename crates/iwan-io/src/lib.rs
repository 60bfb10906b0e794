//! Measured and simulated records: CSV, NPY/NPZ, UFF 58/58b and MATLAB v5 files; tables of results.
//!
//! [`read`] turns a file into a [`Record`]: uniformly sampled channels, checked once. [`Table`] writes columns of
//! results as CSV, NPZ or Parquet. [`atomic`] makes files appear whole or not at all.
//!
//! Text files are told by their extension, all others by their content. In a single column, a decimal comma cannot be told from a separator: use a point.

mod assemble;
pub mod atomic;
mod bytes;
mod error;
mod inflate;
mod mat;
mod npy;
mod npz;
mod options;
mod read;
mod record;
mod sampling;
mod source;
mod table;
mod text;
mod uff;
mod units;
mod variables;
mod warning;

pub use error::ReadError;
pub use options::{Format, ReadOptions};
pub use read::{read, read_bytes};
pub use record::{Quantity, Record, RecordError};
pub use table::{Table, TableError};
pub use text::{Columns, parse_table, read_table};
pub use warning::Warning;
