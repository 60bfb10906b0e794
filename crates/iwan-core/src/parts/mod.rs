//! Parts of a modal law beside its joint: dampers and springs without memory, which are not Iwan models.
//!
//! The law of a mode is a sum: q'' + 2 ζ_v ω0 q' + K_∞ q + F_J(q) + Σ f_i(q, q') = f(t). Each part is one file with its force, its energy
//! where it stores any, and its first-harmonic stiffness and dissipated energy in one cycle of amplitude a and circular frequency ω.

mod cosine_power;
mod power_damping;
mod coulomb;
mod power_spring;
mod pinning;
mod part;

pub use coulomb::Coulomb;
pub use part::{Part, sum_of_parts};
pub use pinning::Pinning;
pub use power_damping::PowerDamping;
pub use power_spring::PowerSpring;
