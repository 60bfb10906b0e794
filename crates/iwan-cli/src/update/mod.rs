//! `iwan update`: joints of a structure from frequency and damping of several modes against amplitude.

mod args;
mod curves;
mod groups;
mod summary;
mod figures;
mod report;
mod command;

pub(crate) use args::UpdateArgs;
pub(crate) use command::run;
