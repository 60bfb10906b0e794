//! Measured records: their options, the way from files to the records of single modes, and each mode by all methods.

mod args;
mod shapes;
mod units;
mod reading;
mod stretches;
mod extraction;

pub(crate) use args::{Axis, MethodChoice, Motion, RecordArgs, band};
pub(crate) use extraction::Extraction;
pub(crate) use reading::{ModalRecord, Recording, Sought, Wanted, modes, read};
pub(crate) use shapes::Shapes;
pub(crate) use stretches::read_all;
pub(crate) use units::Units;
