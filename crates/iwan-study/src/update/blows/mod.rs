//! Joints of a structure from blows on several points: the motion itself is compared, with transients of the reduced structure.

mod struck;
mod rings;
mod straight;
mod settle;
mod from_blows;

pub use from_blows::update_from_blows;
pub use struck::{BlowTask, MeasuredBlow};
