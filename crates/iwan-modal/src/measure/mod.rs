//! What was measured: points with directions, one blow of the hammer with force and responses.

mod freedom;
mod hit;

pub use freedom::{Direction, Freedom};
pub use hit::{Channel, Hit, Motion};
