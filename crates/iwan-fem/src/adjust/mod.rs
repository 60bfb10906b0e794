//! Joints and stiffness as unknowns: modal curves of a reduced structure with exact derivatives.

mod adjustable;
mod adjusted;
mod mode;
mod equilibrium;
mod curve;
mod struck;

pub use adjustable::{Adjustable, Correction};
pub use adjusted::Adjusted;
pub use curve::{CurvePoint, Stiffness};
pub use mode::AdjustedMode;
pub use struck::{Blow, InCoordinates, Kinematic, Struck};
