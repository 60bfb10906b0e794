//! `iwan update`: joints of a structure from frequency and damping of several modes against amplitude, and from blows on several points.

mod args;
mod curves;
mod blows;
mod groups;
mod summary;
mod figures;
mod report;
mod command;

pub(crate) use args::UpdateArgs;
pub(crate) use command::run;
