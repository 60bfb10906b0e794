//! Finite-element truth model of bolted structures with discrete Iwan joints.
//!
//! The way of the data: [`mesh`] → matrices → modes → reduced model → joints → truth response → modal filter → record.
//! Units are the user's own consistent set.

pub mod check;
mod element;
mod error;
mod material;
pub mod mesh;

pub use element::{ElementMatrices, Formulation, Inertia};
pub use error::Error;
pub use material::Material;
