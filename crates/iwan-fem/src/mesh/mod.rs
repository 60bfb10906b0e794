//! Nodes, elements and named sets: the result of every reader and the input of the assembly.

mod topology;
mod face;
mod constraint;
mod tie;

pub mod block;
pub mod beam;

mod axes;
mod error;
mod file;
mod labels;
mod sets;
mod abaqus;
mod gmsh;
mod nastran;
mod read;

pub mod vtu;

pub use constraint::{Constraint, Directions, Freedom, GLOBAL, PointMass, Rule, Section, Weighted};
pub use error::{MeshError, MeshWarning};
pub use face::Face;
pub use file::MeshFile;
pub use read::{read, read_bytes, read_ignoring};
pub(crate) use tie::Sides;
pub use topology::{Element, Mesh, Shape};
