//! `iwan reproduce`: the paper's tables and figures beside ours.

mod args;
mod units;
mod plate;
mod schematics;
mod blow_figures;
mod laboratory_figures;
mod figures;
mod curves;
mod summary;
mod tables;
mod report;
mod command;

pub(crate) use args::ReproduceArgs;
pub(crate) use command::run;
