//! Nodes, elements and named sets: what every reader delivers and the assembly starts from.

mod topology;
mod surface;

pub mod block;
pub mod beam;

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
pub use read::{read, read_bytes};
pub use topology::{Element, Mesh, Shape};
