//! Steady vibration: the Fourier coefficients of a joint's force and their derivatives, exact in the continuum.
//!
//! A steady loop consists of pieces of the virgin curve between the turning points of the motion. Within one period the largest excursion
//! erases all earlier history (return-point memory). So no second period, no samples and no sliders are needed.

mod harmonics;
mod turns;
mod panel;
mod walk;
mod coefficients;
mod one_harmonic;

pub use coefficients::steady_force;
pub use harmonics::{Harmonics, MOST_HARMONICS};
pub use one_harmonic::one_harmonic;
pub use walk::SteadyWork;
