//! From a ring-down record to the parameters of an Iwan joint, with an honest word on what the record can tell.
//!
//! The way of the data: record → [`signal`] (band-pass, envelope, frequency) → [`curves`] (damping, dissipation and
//! force against amplitude) → [`mod@start`], [`mod@fit`] (parameters), [`mod@density`] (a density of any form) → [`mod@refine`] (on the record itself). Units are the
//! user's own consistent set; frequencies in Hz, times in seconds, damping as a ratio.
//!
//! Method: Deaner, Allen, Starr, Segalman, *Investigation of Modal Iwan Models for Structures with Bolted Joints*
//! ("the paper" in this documentation; equation numbers are the paper's).

mod chart;
pub mod combination;
pub mod curves;
pub mod density;
mod error;
mod features;
pub mod fit;
pub mod identify;
mod least_squares;
pub mod levels;
pub mod likelihood;
pub mod modal;
mod non_negative;
mod parameters;
pub mod profile;
pub mod quasi_static;
pub mod refine;
pub mod signal;
mod smooth;
pub mod start;
mod verdict;

pub use error::Error;
pub use parameters::{Parameter, Parameters};
pub use verdict::Verdict;
