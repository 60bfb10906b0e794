//! Structures out again: their matrices, and reduced models as folders that open.

mod written;
mod reduced;
mod updated;

pub use reduced::ReducedFolder;
pub use updated::{Changes, updated_structure};
pub use written::{MatrixFormat, matrix_file_names, matrix_files};
