//! A scenario on a finite-element structure.

mod run;
mod summary;
mod report;
mod command;

pub(super) use command::run;
