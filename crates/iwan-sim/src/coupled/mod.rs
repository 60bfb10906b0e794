//! Coupled modes: one joint, all modes. Stuck modes are linear oscillators, and each joint feels the sum of them.

mod joint;
mod response;
mod task;
mod run;
mod simulate;

pub use joint::SharedJoint;
pub use response::{CoupledResponse, JointHistory};
pub use simulate::{check_coupled, simulate_coupled};
pub(crate) use task::assembled;
