//! From what a reader found to a checked record: units, the uniform grid of times, and which of the arrays are channels.

pub(crate) mod scales;
pub(crate) mod units;
mod variable;
pub(crate) mod clocks;
mod sampling;
mod assemble;
mod alike;
mod variables;

pub(crate) use alike::{SAME_INTERVAL, unlike};
pub(crate) use assemble::{Axis, Channel, Raw, all_channels, assemble};
pub(crate) use sampling::last_digit;
pub use units::{quantity_of_unit, unit_of_times};
pub(crate) use variable::Variable;
pub(crate) use variables::Chooser;
