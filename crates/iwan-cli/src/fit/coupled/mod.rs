//! `iwan fit --coupled`: several modes of several records at once, with joints that they share or do not.

mod records;
mod summary;
mod scenario;
mod figures;
mod report;
mod results;
mod command;

pub(crate) use command::fit;
pub(crate) use records::{Loaded, Measured};
pub(crate) use results::CoupledResults;
