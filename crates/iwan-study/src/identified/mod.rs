//! A mode that was identified from records, and the comparison of its ring-downs with them.

mod ring_down;
mod by_law;
mod comparison;
mod identified_mode;

pub use by_law::{mode_of_curves, mode_of_law};
pub use comparison::{Comparison, RecordOfMode};
pub use identified_mode::IdentifiedMode;
pub use ring_down::time_step;
