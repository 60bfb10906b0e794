//! Studies that need structures, simulation and identification together.
//!
//! [`reproduce`] computes the paper anew: the beam under blows, its modal Iwan models, synthetic measurements; [`Summary`] is
//! that in numbers, with findings in words. [`identified`] sets the ring-down of an identified mode beside its records.
//! Nothing here draws, prints or reads a file.
//!
//! The paper: Deaner, Allen, Starr, Segalman, *Investigation of Modal Iwan Models for Structures with Bolted Joints*; equation,
//! table and figure numbers are the paper's.

// Errors and progress of a study, and small helpers for numbers
mod error;
mod progress;
mod span;
mod relative_difference;

// A mode that was identified from records, compared with them
pub mod identified;

// The values that the paper prints, and the blows on its beam
pub mod printed;
pub mod blows;

// The beam as the truth, its modes with their modal models, and a laboratory's view of it
pub mod beam;
pub mod modes;
pub mod laboratory;

// The joints of any structure from measurements of its modes
pub mod update;

// The whole reproduction, in words and in numbers
mod reproduction;
pub mod findings;
pub mod summary;

pub use error::Error;
pub use relative_difference::relative_difference;
pub use reproduction::{Reproduction, StudiedBeam, reproduce};
pub use span::Span;
pub use summary::Summary;
