//! Nodes, elements and named sets: what every reader delivers and the assembly starts from.

mod topology;
mod surface;

pub mod block;
pub mod beam;

mod axes;
mod error;
mod file;
mod labels;
mod sets;
mod abaqus;
mod gmsh;
mod read;

pub mod vtu;

pub use error::{MeshError, MeshWarning};
pub use file::MeshFile;
pub use read::{read, read_bytes, read_ignoring};
pub use topology::{Element, Mesh, Shape};
