//! Conversions between Python and Rust: arrays, arguments by their names, exceptions in Python's words, choices by name, texts that Python can read again, texts as files, and work
//! without the interpreter's lock.

pub(crate) mod arguments;
pub(crate) mod errors;
pub(crate) mod array;
pub(crate) mod named;
pub(crate) mod files;
pub(crate) mod options;
pub(crate) mod pickle;
pub(crate) mod repr;
pub(crate) mod work;
