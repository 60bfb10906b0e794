//! `iwan modes`: frequencies and shapes of a structure with its joints stuck and slipping.

mod args;
mod summary;
mod report;
mod command;

pub(crate) use args::ModesArgs;
pub(crate) use command::run;
