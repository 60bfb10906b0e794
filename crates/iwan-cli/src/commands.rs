//! The command `iwan reproduce`.

pub(crate) mod reproduce;
