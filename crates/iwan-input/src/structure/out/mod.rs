//! Structures out again: their matrices, and reduced models as folders that open.

mod written;
mod reduced;

pub use reduced::ReducedFolder;
pub use written::{MatrixFormat, matrix_file_names, matrix_files};
