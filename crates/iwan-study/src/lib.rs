//! Studies that need structures, simulation and identification together.
//!
//! [`reproduce`] computes the paper anew: the beam under blows, its modal Iwan models, synthetic measurements; [`Summary`] is
//! that in numbers, with findings in words. [`identified`] sets the ring-down of an identified mode beside its records.
//! Nothing here draws, prints or reads a file.
//!
//! The paper: Deaner, Allen, Starr, Segalman, *Investigation of Modal Iwan Models for Structures with Bolted Joints*; equation,
//! table and figure numbers are the paper's.

// How a study fails, how far it is, and how it writes numbers
mod error;
mod progress;
mod span;
mod relative_difference;

// A mode that was found in records, beside them
pub mod identified;

// What the paper prints, and what it does to its beam
pub mod printed;
pub mod blows;

// The beam as the truth, its modes with their modal models, and a laboratory's view of it
pub mod beam;
pub mod modes;
pub mod laboratory;

// The joints of any structure from what its modes show
pub mod update;

// All of it together, in words and in numbers
mod reproduction;
pub mod findings;
pub mod summary;

pub use error::Error;
pub use relative_difference::relative_difference;
pub use reproduction::{Reproduction, StudiedBeam, reproduce};
pub use span::Span;
pub use summary::Summary;
