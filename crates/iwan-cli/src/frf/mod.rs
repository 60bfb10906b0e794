//! `iwan frf`: steady forced responses at given force or given response.

mod args;
mod loops;
mod responses;
mod backbones;
mod structure;
mod coupled;
mod summary;
mod figures;
mod report;
mod command;

pub(crate) use args::FrfArgs;
pub(crate) use command::run;
