//! Finite-element structures, as several commands need them: options, the linear modes, the size, the picture of the mesh.

mod args;
pub(crate) mod linear;
mod size;
pub(crate) mod picture;
mod steady;

pub(crate) use args::StructureArgs;
pub(crate) use linear::Linear;
pub(crate) use size::Size;
pub(crate) use steady::{Asked, steady};
