//! `iwan envelope`: amplitude, frequency and damping of a ring-down against time.

mod args;
mod summary;
mod picture;
mod peaks;
mod figures;
mod report;
mod command;

pub(crate) use args::EnvelopeArgs;
pub(crate) use command::run;
pub(crate) use figures::Extracted;
pub(crate) use report::units;
pub(crate) use summary::{RecordSummary, agreement};
