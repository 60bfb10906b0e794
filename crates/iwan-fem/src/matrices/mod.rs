//! Equations of a structure from its description: stiffness and mass for unknowns that are displacements and slips.

mod unknowns;
mod elimination;
mod constraint_equations;
mod point_masses;
mod joint_equations;
mod row_equations;
mod given_matrices;
mod assembly;
mod row_forces;
mod base_motion;
mod fingerprint;

pub use assembly::Assembled;
pub use joint_equations::SlipUnknown;
pub(crate) use joint_equations::inverse_of;
pub use unknowns::Unknown;
