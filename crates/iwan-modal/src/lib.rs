//! From hammer hits to modes: frequency responses, poles with standard deviations, mass-normalised mode shapes.
//!
//! The way of the data: [`measure::Hit`] (force and responses of one blow) → [`responses::FrequencyResponses`] (H1, H2, Hv) →
//! [`poles`] (where the modes are: least-squares complex frequency with a stabilisation chart, or mode isolation) → [`fit`] (all
//! poles together by maximum likelihood; the model includes what the end of the record cuts off) → [`modes`] (shapes).
//! [`modal_fit`] does all of it in one call. Units are the user's own consistent set; frequencies in Hz, damping as a ratio.

// What all other modules use: errors, complex numbers.
mod error;
mod number;

// What was measured: points and directions, hits, how good they are.
pub mod measure;

// From hits to frequency responses.
pub mod responses;

// All poles together, against all responses.
pub mod fit;

// Where the modes are: candidates for poles.
pub mod poles;

// What poles and residues say about modes.
pub mod modes;

// The whole analysis in one call.
mod analysis;

// What a fit itself casts doubt on.
mod doubts;

// The scale of shapes of modes that are not linear.
mod begin;

// The number of threads.
mod threads;

// The time from which on a decay is linear.
mod zeroed;

pub use analysis::{Analysis, ModalFit, modal_fit, modal_fit_by_subspaces};
pub use error::Error;
pub use nalgebra::Complex;
pub use threads::{each_of, on_threads};
pub use zeroed::{LinearFrom, Zeroed, ZeroedSpectrum, zeroed};
