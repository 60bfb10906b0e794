//! Structure files: mesh, materials, joints and ties, supports, loads and outputs.

mod sets;
mod meshes;
mod given;
mod materials;
mod ends;
mod joints;
mod between_rows;
mod built_in;
mod file;
mod out;
mod sought;
mod run;
mod steady;

#[cfg(test)]
mod schema_tests;
#[cfg(test)]
mod tests;

pub use built_in::{BUILT_IN_STRUCTURES, built_in_structure};
pub use ends::{Load, Output, Point};
pub use file::{STRUCTURE_SCHEMA, StructureFile, is_structure};
pub use joints::StructureLaw;
pub use out::{Changes, MatrixFormat, ReducedFolder, matrix_file_names, matrix_files, updated_structure};
pub use run::{RunError, StructureTask};
pub use steady::{Drive, SteadyStructure, SteadyTask};
