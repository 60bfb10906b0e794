//! Memories: evaluations of the hysteretic force of a law along any history of displacement.
//!
//! [`Hysteresis`] is their common interface. Parameters and state are two values, so that one law drives many joints.

mod hysteresis;
mod no_joint;
mod sliders;
mod plain;
mod stick_slip;
mod runs;
mod masing;

pub use hysteresis::{Hysteresis, Trial};
pub(crate) use masing::Branch;
pub use masing::{Continuum, Reversal, Reversals};
pub use no_joint::NoJoint;
pub use plain::{Extensions, Plain};
pub(crate) use runs::Segment;
pub use runs::{Run, Runs, Straight};
pub use sliders::{Slider, Sliders};
pub use stick_slip::{Spring, Springs, StickSlip};
