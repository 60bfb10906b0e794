//! `iwan fit --sweep --backbone`: a mode from a shaker's test, with ring-downs or without.

mod columns;
mod measurement;
mod predicted;
mod summary;
mod scenario;
mod figures;
mod report;
mod command;

pub(crate) use columns::{Content, read as read_columns};
pub(crate) use command::{RingDowns, fit};
pub(crate) use measurement::{Measurement, Scaling};
