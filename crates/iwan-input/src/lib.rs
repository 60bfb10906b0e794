//! Input files in the project's own format (TOML), read by the command line and the Python package alike.
//!
//! [`InputText`] is a text with its name; [`Section`] is a table of the text, read key by key: every message names file, line, key,
//! value, allowed range and remedy, and for unknown keys the nearest known one. [`WrittenLaw`] is a joint law as written;
//! [`StructureFile`] is a structure: mesh, materials, joints, supports, loads, outputs; [`scenario`] describes
//! simulations on modes or on a structure. No other crate reads TOML by itself.

// The basis: the text with its name, and the errors about it.
mod error;
mod text;

// A table, key by key.
mod section;

// The shipped schemas beside the keys that the readers know.
#[cfg(test)]
mod schema;

// What the tables mean.
mod written_law;
mod modal_test;
mod structure;
pub mod scenario;

// From a structure to coupled modes.
mod coupled;

pub use coupled::CoupledScenario;
pub use error::InputError;
pub use modal_test::{ChannelEntry, ModalTable, PointEntry, Role};
pub use section::{Document, Section, TableKind, TablePlace, known, nearest, plain};
pub use structure::{
    BUILT_IN_STRUCTURES, Changes, Drive, Load, MatrixFormat, Output, Point, ReducedFolder, RunError,
    STRUCTURE_SCHEMA, SteadyStructure, SteadyTask, StructureFile, StructureLaw, StructureTask,
    built_in_structure, is_structure, matrix_file_names, matrix_files, updated_structure,
};
pub use text::InputText;
pub use written_law::{LAWS, WrittenLaw};
