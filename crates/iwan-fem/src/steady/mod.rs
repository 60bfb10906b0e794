//! Steady vibration of structures: the reduced model in the form that harmonic balance needs.

mod slip_modes;

pub use slip_modes::{SteadyCoordinate, SteadyModel, SteadySlip};
