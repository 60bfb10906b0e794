//! `iwan simulate`: from a scenario to responses, a summary and a report.

mod args;
mod explain;
mod files;
mod summary;
mod joints;
mod figures;
mod report;
mod streamed;
mod structure;
mod command;

pub(crate) use args::SimulateArgs;
pub(crate) use command::run;
pub(crate) use files::response_columns;
