//! Coupled modes: linear oscillators at their stuck frequencies, whose displacements together move a few hysteretic joints.
//!
//! With modal displacements q_r and slips s_j,
//!
//! q_r'' + 2 ζ_r ω_r q_r' + ω_r² q_r + Σ_j b_jr N_j = φ_r f(t),
//!
//! s_j = Σ_r b_jr q_r - Σ_l ρ_jl N_l + a_j f(t),   N_j = F_j[s_j] - K_j s_j.
//!
//! F_j is the hysteretic force of joint j and K_j its initial stiffness, so N_j is the force of the joint less the force that it would have
//! if stuck. b_jr is the slip of joint j in a unit displacement of stuck mode r. The modes that are left out follow statically, with the
//! compliance ρ of the slips and the slips a of a unit load. This model is the projection of a structure with discrete joints on its stuck
//! modes; the paper's modal joint (Deaner et al., Eq. 5) lets each mode slip by itself instead. The residual compliance is that of R. R.
//! Craig Jr. and C.-J. Chang (NASA CR-2893, 1977).

mod lanes;
mod definite;
mod modes;
mod joints;
mod motion;
mod several;
mod stepper;
mod glide;
mod energy;

pub use energy::CoupledEnergy;
pub use joints::{JointsInMotion, OneJoint};
pub use lanes::{LANES, Lanes, groups};
pub use modes::{CoupledJoint, CoupledMode, CoupledModes};
pub use motion::CoupledMotion;
pub use several::SeveralJoints;
pub use stepper::CoupledRows;
