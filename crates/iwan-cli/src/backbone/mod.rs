//! `iwan backbone`: nonlinear modes.

mod args;
mod curves;
mod structure;
mod summary;
mod report;
mod command;

pub(crate) use args::BackboneArgs;
pub(crate) use command::run;
