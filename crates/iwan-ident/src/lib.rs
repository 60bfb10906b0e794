//! From a ring-down record to the parameters of an Iwan joint, with intervals and verdicts that say what the record can tell.
//!
//! The way of the data: record → [`signal`] (band-pass, envelope, frequency) → [`curves`] (damping, dissipation and
//! force against amplitude) → [`curve_fit`] (start values, parameters, verdict), [`mod@density`] (a density of any
//! form) → [`mod@refine`] (on the record itself) → [`profile`] (intervals). [`mod@identify`] does all of it in one call. Units are the
//! user's own consistent set; frequencies in Hz, times in seconds, damping as a ratio.
//!
//! Method: Deaner, Allen, Starr, Segalman, *Investigation of Modal Iwan Models for Structures with Bolted Joints*
//! ("the paper" in this documentation; equation numbers are the paper's).

// What all other modules use: errors, quantiles, the six parameters, smooth curves through noise, searches.
mod error;
mod turn;
mod student;
mod parameters;
mod smooth;
mod search;

// From samples to curves: one record to one mode, many channels to one record, amplitude to dissipation.
pub mod signal;
pub mod channels;
pub mod curves;

// What curves tell: parameters with a verdict, parameters from a computed structure's curves, comparison of force levels, densities of any form.
pub mod curve_fit;
pub mod static_fit;
pub mod levels;
pub mod density;

// What the records themselves tell: the model's ring-down compared with the record, intervals, the likelihood.
pub mod refine;
pub mod profile;
pub mod likelihood;

// Estimates of the unknowns of any model that brings its derivatives.
pub mod estimate;

// Several modes at once, with joints that they share or joints of their own.
pub mod coupled;

// What a shaker's test tells, alone or together with ring-downs.
pub mod sweeps;

// Other laws beside one Iwan joint, compared by evidence; smooth curves as a model of every record.
pub mod laws;

// The whole identification in one call.
pub mod identify;

pub use curve_fit::{Grade, Verdict};
pub use error::Error;
pub use parameters::{Parameter, Parameters};
