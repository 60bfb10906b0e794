//! `iwan fit --sweep --backbone`: a mode from a shaker's test, with ring-downs or without.

mod columns;
mod measurement;
mod test;
mod predicted;
mod summary;
mod scenario;
mod figures;
mod report;
mod results;
mod command;

pub(crate) use columns::{Content, read as read_columns};
pub(crate) use command::fit;
pub(crate) use measurement::{Measurement, Scaling};
pub(crate) use results::Results;
pub(crate) use test::{RingDowns, ShakerTest};
