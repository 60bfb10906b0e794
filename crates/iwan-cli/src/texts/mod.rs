//! Commands that print a text and compute nothing.

pub(crate) mod completions;
pub(crate) mod man;
pub(crate) mod scenario;
