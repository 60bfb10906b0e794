//! Steady vibration of structures: what harmonic balance needs of the reduced model.

mod slip_modes;

pub use slip_modes::{SteadyCoordinate, SteadyModel, SteadySlip};
