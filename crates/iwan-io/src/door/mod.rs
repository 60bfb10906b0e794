//! The entry points to all formats: one for a record whose channels measure one quantity, one for all channels of a modal test.

mod read;
mod measurement;

pub use measurement::{MeasuredChannel, Measurement, ModalTest, read_modal_test};
pub use read::{read, read_bytes};
