//! `iwan fit`: from records to the parameters of an Iwan joint, with intervals and a verdict.

mod laws;
mod args;
mod modal;
mod summary;
mod scenario;
mod figures;
mod intervals;
mod report;
mod command;

pub(crate) use args::FitArgs;
pub(crate) use command::run;
pub(crate) use report::{Reported, render};
pub(crate) use scenario::as_scenario;
pub(crate) use summary::FitSummary;
