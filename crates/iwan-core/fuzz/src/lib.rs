//! What all targets share: laws and histories off bytes, and what holds along any history.

mod bytes;
mod driven;

pub use bytes::{Bytes, elements, four_parameter, grid, law, table_of_density};
pub use driven::{Driven, Law, Move};
