//! A mode that was identified from records, and its ring-downs beside them.

mod ring_down;
mod comparison;
mod identified_mode;

pub use comparison::{Comparison, RecordOfMode};
pub use identified_mode::IdentifiedMode;
pub use ring_down::time_step;
