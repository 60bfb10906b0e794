//! Where the modes are: candidates for poles, by two ways that know nothing of each other.
//!
//! Least-squares complex frequency fits one rational function of many orders and looks for poles that stay; mode isolation takes one
//! mode after another off the composite response.

mod polynomial;
mod chart;
mod residue_peak;
mod isolation;

pub(crate) use chart::chart;
pub use chart::{Candidate, ChartPole, Stabilisation, stabilisation};
pub(crate) use isolation::isolation;
pub use isolation::{Isolation, Step, isolate};
