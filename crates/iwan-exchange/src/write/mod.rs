//! Matrices and arrays as files that other programs read.

mod columns;
mod arrays;
mod matrix_market;
mod mat;
mod npz;

pub use arrays::{ArrayRef, StoredArray, arrays_to_npz, read_arrays};
pub use mat::to_mat;
pub use matrix_market::to_matrix_market;
pub use npz::to_npz;
