//! The doors to all formats: a record of channels that measure one thing, and all channels of a modal test.

mod read;
mod measurement;

pub use measurement::{MeasuredChannel, Measurement, ModalTest, read_modal_test};
pub use read::{read, read_bytes};
