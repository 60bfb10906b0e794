//! Modes from poles and residues: mass-normalised shapes, how alike and how complex they are, reciprocity.

mod compare;
mod shape;
mod sideband;

pub use compare::{mac, phase_collinearity};
pub(crate) use shape::modes;
pub use shape::{Drive, Mode, Scale};
pub(crate) use sideband::sidebands;
pub use sideband::{Sideband, Sidebands};
