//! Writers of structures: their matrices, reduced models as folders, and updated structure files.

mod written;
mod reduced;
mod updated;

pub use reduced::ReducedFolder;
pub use updated::{Changes, updated_structure};
pub use written::{MatrixFormat, matrix_file_names, matrix_files};
