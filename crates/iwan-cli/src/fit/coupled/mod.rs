//! `iwan fit --coupled`: several modes of several records at once, with joints that they share or do not.

mod records;
mod summary;
mod scenario;
mod figures;
mod report;
mod command;

pub(crate) use command::fit;
