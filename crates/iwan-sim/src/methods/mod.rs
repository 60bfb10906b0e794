//! One mode by one method, with the companion runs that estimate its errors.

pub(crate) mod run;
pub(crate) mod quality;
pub(crate) mod event;
pub(crate) mod free_decay;
