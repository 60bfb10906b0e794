//! Finite-element truth model of bolted structures with discrete Iwan joints.
//!
//! The way of the data: [`mesh`] → matrices → modes → reduced model → joints → truth response → modal filter → record.
//! Units are the user's own consistent set.

mod assembly;
mod constraints;
mod dofs;
mod eigen;
mod element;
mod error;
mod factor;
mod joint;
mod material;
pub mod mesh;
mod modes;
mod ordering;
pub mod paper;

mod sparse;

mod structure;

pub mod check;

pub use assembly::Assembled;
pub use dofs::Unknown;
pub use element::{ElementMatrices, Formulation, Inertia};
pub use error::Error;
pub use joint::SlipUnknown;
pub use material::Material;
pub use modes::{Class, Contact, JointMode, Modes};
pub use sparse::Symmetric;
pub use structure::{Interface, Joint, Law, Lump, Patch, Slip, Structure, Support};
