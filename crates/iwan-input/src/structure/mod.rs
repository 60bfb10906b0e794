//! Structure files: mesh, materials, joints and ties, supports, loads and outputs.

mod sets;
mod meshes;
mod row_map;
mod matrices;
mod materials;
mod ends;
mod joints;
mod built_in;
mod file;
mod run;
mod out;

#[cfg(test)]
mod schema_tests;
#[cfg(test)]
mod tests;

pub use built_in::{BUILT_IN_STRUCTURES, built_in_structure};
pub use ends::{Load, Output};
pub use file::{STRUCTURE_SCHEMA, StructureFile, is_structure};
pub use joints::StructureLaw;
pub use out::{MatrixFormat, ReducedFolder, matrix_file_names, matrix_files};
pub use run::{RunError, StructureTask};
