//! `iwan quasi-static`: modal curves from static loads, and modal Iwan parameters from them.

mod args;
mod analysis;
mod summary;
mod figures;
mod report;
mod command;

pub(crate) use args::QuasiStaticArgs;
pub(crate) use command::run;
