//! `iwan frf`: steady forced responses at given force or given response.

mod args;
mod responses;
mod structure;
mod summary;
mod figures;
mod report;
mod command;

pub(crate) use args::FrfArgs;
pub(crate) use command::run;
