//! Evaluation of the blows' records for each bending mode, and the modal Iwan model derived from it.

mod impact_curves;
mod static_loads;
mod slopes;
mod bending_mode;
mod modal_model;
mod counterpart;
mod coupled_model;
mod studied_mode;

pub use bending_mode::BendingMode;
pub use counterpart::{Counterpart, Distance, EARLY, FITTED, Interval, SHOWN};
pub use coupled_model::{CoupledMode, CoupledModel};
pub use impact_curves::Reading;
pub use slopes::{Eq14Axis, Eq14Root, Slopes};
pub use static_loads::{Coupling, MICRO_SLIP};
pub use studied_mode::StudiedMode;
