//! The report of `iwan reproduce`.

pub(crate) mod reproduce;
