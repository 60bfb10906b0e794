//! Candidates for poles, found in several ways that are independent of each other.
//!
//! Least-squares complex frequency fits rational functions of many orders and looks for poles that stay from order to order; mode isolation takes one
//! mode after another off the composite response; subspaces find poles from the samples of free decays.

mod polynomial;
mod chart;
mod residue_peak;
mod isolation;
mod subspace;

pub(crate) use chart::chart;
pub use chart::{Candidate, ChartPole, Stabilisation, stabilisation};
pub use isolation::{Isolation, Step, isolate};
pub(crate) use isolation::{isolation, isolation_alone};
pub use subspace::subspace;
