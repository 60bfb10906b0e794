//! Where the modes are: candidates for poles, by ways that know nothing of each other.
//!
//! Least-squares complex frequency fits one rational function of many orders and looks for poles that stay; mode isolation takes one
//! mode after another off the composite response; subspaces read poles off the samples of free decays.

mod polynomial;
mod chart;
mod residue_peak;
mod isolation;
mod subspace;

pub(crate) use chart::chart;
pub use chart::{Candidate, ChartPole, Stabilisation, stabilisation};
pub(crate) use isolation::isolation;
pub use isolation::{Isolation, Step, isolate};
pub use subspace::subspace;
