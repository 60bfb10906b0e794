//! One mode by one method, with the companion runs that estimate its errors.

pub(crate) mod between;
pub(crate) mod task;
pub(crate) mod stepped;
pub(crate) mod outside;
pub(crate) mod run;
pub(crate) mod quality;
pub(crate) mod event;
pub(crate) mod free_decay;
pub(crate) mod averaged;
