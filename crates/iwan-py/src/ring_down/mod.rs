//! Ring-downs of modes: one, several, or very many.

pub(crate) mod response;
pub(crate) mod simulate;
pub(crate) mod coupled;
pub(crate) mod ensemble;
