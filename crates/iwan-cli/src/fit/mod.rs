//! `iwan fit`: from records to the parameters of an Iwan joint, with intervals and a verdict.

mod laws;
mod args;
mod modal;
mod joint;
mod intervals;
mod summary;
mod sweeps;
mod coupled;
mod scenario;
mod figures;
mod report;
mod command;

pub(crate) use args::FitArgs;
pub(crate) use command::run;
pub(crate) use coupled::{CoupledResults, Loaded, Measured};
pub(crate) use report::{Reported, render};
pub(crate) use scenario::as_scenario;
pub(crate) use summary::FitSummary;
pub(crate) use sweeps::{Content, Measurement, Results, RingDowns, Scaling, ShakerTest, read_columns};
