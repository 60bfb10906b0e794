//! Input files of the project's own (TOML): what the command line and the Python package both read.
//!
//! [`Source`] is a text with its name, [`Section`] a table of it read key by key: every message names file, line, key,
//! value, allowed range and remedy, and for unknown keys the nearest known one. [`Joint`] is a joint law as written,
//! [`StructureFile`] a structure: mesh, materials, joints, supports, loads, outputs; [`scenario`] holds what is simulated on
//! modes or on a structure.

mod error;
mod numbers;
mod source;

mod section;

mod joint;
mod structure;
pub mod scenario;

pub use error::InputError;
pub use joint::{Joint, LAWS};
pub use numbers::significant;
pub use section::{Kind, Section, known, nearest, plain};
pub use source::Source;
pub use structure::{BUILT_IN_STRUCTURES, Load, Output, STRUCTURE_SCHEMA, StructureFile, built_in_structure};
