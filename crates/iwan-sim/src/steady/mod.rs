//! Steady vibration: forced responses at held force or held response, and nonlinear modes.

mod sweep;
mod curve;
mod jointed;
mod one_mode;
mod shared;
mod receptance;
mod balance;
mod continuation;
mod problems;
mod respond;
mod nonlinear_mode;

pub use curve::{Jump, SteadyCurve, SteadyPoint, Superharmonic};
pub use jointed::{JointedModes, Residual, SharedLaw, SlipJoint, StuckMode};
pub use nonlinear_mode::{BackbonePoint, NonlinearMode, backbone, nonlinear_mode};
pub use respond::{forced_response, forced_response_of};
pub use shared::StuckRange;
pub use sweep::{Control, Sweep};
