//! Conversions between Python and Rust: arrays, exceptions, choices by name, texts that Python can read again, and work without the
//! interpreter's lock.

pub(crate) mod errors;
pub(crate) mod array;
pub(crate) mod options;
pub(crate) mod pickle;
pub(crate) mod repr;
pub(crate) mod work;
