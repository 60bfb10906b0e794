//! Matrices of other programs as triplets with row maps: Abaqus, Nastran, Sierra/SD, CalculiX, MATLAB, SciPy, Matrix Market.
//!
//! [`read`] turns a file into [`Matrix`] values: rows, columns, entries, and what the file says about the rows. Nothing here knows
//! what a stiffness is. No count in a file is trusted for an allocation.

// What everything stands on: why a file was refused, a matrix, a file in memory that names itself in every error.
mod error;
mod matrix;
mod source;

// One room for each family of formats.
mod text;
mod nastran;
mod packed;

// One door to all formats, and the map from rows to nodes where it is a file of its own.
mod read;
mod row_map;

// And out again.
mod write;

pub use error::ExchangeError;
pub use matrix::{Asymmetry, Component, Entry, Label, Matrix, Stored};
pub use read::{Format, read, read_bytes};
pub use row_map::{read_positions, read_rows};
pub use write::{ArrayRef, StoredArray, arrays_to_npz, read_arrays, to_mat, to_matrix_market, to_npz};
