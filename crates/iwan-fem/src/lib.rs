//! Finite-element truth model of bolted structures with discrete Iwan joints.
//!
//! The way of the data: [`mesh`] → matrices → modes → reduced model → joints → truth response → modal filter → record.
//! Units are the user's own consistent set.

mod assembly;
mod constraints;
mod contact;
mod converged;
mod dense;
mod dofs;
mod eigen;
mod element;
mod error;
mod factor;
mod full_stepper;
mod joint;
mod lanes;
mod material;
pub mod mesh;
mod modal_filter;
mod modes;
mod nodal_product;
mod quasi_static;
mod reduced_transient;
mod reduction;
mod slip_solver;
mod transient;
mod triangular;
mod workers;

mod modal_force;
mod model;
mod named_modes;
mod static_range;

mod ordering;
pub mod paper;

mod sparse;

mod structure;

pub mod check;

pub use assembly::Assembled;
pub use contact::Population;
pub use converged::Converged;
pub use dofs::Unknown;
pub use element::{ElementMatrices, Formulation, Inertia};
pub use error::Error;
pub use joint::SlipUnknown;
pub use material::Material;
pub use modal_filter::ModalFilter;
pub use model::{Integrated, Model, StepErrors};
pub use modes::{Class, Contact, JointMode, Modes};
pub use named_modes::{NamedMode, NamedModes};
pub use quasi_static::{ModalCurves, QuasiStatic};
pub use reduction::{Basis, Reduced};
pub use sparse::Symmetric;
pub use structure::{Interface, Joint, Law, Lump, Patch, Slip, Structure, Support};
pub use transient::{History, Output, Progress, SlipHistory, Transient, TruthResponse};
