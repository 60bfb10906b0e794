//! Modal curves without a transient: frequency and dissipation against amplitude, from static loads.

mod curves;
mod range;
mod slip_statics;

pub use curves::{ModalCurves, QuasiStatic};
pub use slip_statics::{SlipFlexibility, SlipGroup, SlipStatics};
