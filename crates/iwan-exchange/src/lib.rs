//! Matrices of other programs as triplets with row maps: Abaqus, Nastran, Sierra/SD, CalculiX, MATLAB, SciPy, Matrix Market.
//!
//! [`read`] turns a file into [`Matrix`] values: rows, columns, entries, and what the file says about the rows. The physical meaning of a
//! matrix, such as stiffness, plays no role here. No count in a file is trusted for an allocation.

// The basis: why a file was refused, a matrix, a file in memory that names itself in every error.
mod error;
mod matrix;
mod source;

// One module for each family of formats.
mod text;
mod nastran;
mod packed;

// The entry point to all formats, and the map from rows to nodes where a file of its own holds it.
mod read;
mod row_map;

// Writers.
mod write;

pub use error::ExchangeError;
pub use matrix::{Asymmetry, Component, Entry, Label, Matrix, Stored};
pub use read::{Format, read, read_bytes};
pub use row_map::{read_positions, read_rows};
pub use write::{ArrayRef, StoredArray, arrays_to_npz, read_arrays, to_mat, to_matrix_market, to_npz};
