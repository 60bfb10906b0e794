//! Coupled modes: several modes share a joint. Stuck modes are linear oscillators, and the slip of each joint is a sum over the modes.

mod joint;
mod response;
mod task;
mod run;
mod simulate;

pub use joint::SharedJoint;
pub use response::{CoupledResponse, JointHistory};
pub use simulate::{check_coupled, simulate_coupled};
pub(crate) use task::assembled;
