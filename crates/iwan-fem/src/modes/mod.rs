//! Linear vibration of a structure in its two limits: all joints stuck, or all slipping.

mod linear;
mod kept;
mod class;
mod joint_mode;
mod named;
mod filter;

pub use class::Class;
pub use filter::ModalFilter;
pub use joint_mode::JointMode;
pub use linear::{Limit, Modes};
pub use named::{NamedMode, NamedModes};
