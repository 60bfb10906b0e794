//! What is measured: points with directions, one blow of the hammer with force and responses.

mod freedom;
mod hit;
mod pulse;
mod cut;
mod quality;

pub use cut::cut;
pub use freedom::{Direction, Freedom};
pub use hit::{Channel, Hit, Motion};
pub use pulse::Pulse;
pub use quality::{Fault, faults, levels};
