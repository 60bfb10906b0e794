//! Ring-downs of modes: of one, of several, or of a large ensemble.

pub(crate) mod response;
pub(crate) mod simulate;
pub(crate) mod coupled;
pub(crate) mod ensemble;
