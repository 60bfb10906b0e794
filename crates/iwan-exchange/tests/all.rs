//! All tests of iwan-exchange in one program: linked once, and run side by side.

mod common;

mod broken_matrices;
mod matrix_any_bytes;
mod matrix_formats;
