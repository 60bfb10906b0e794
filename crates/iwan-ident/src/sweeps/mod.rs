//! Parameters from a shaker's test: stepped-sine responses, phase-resonance backbones, and ring-downs with them.

mod data;
mod balance;
mod task;
mod start;
mod region;
mod intervals;
mod fit;

pub use data::{BackbonePoint, ResponsePoint, SteadyData};
pub use fit::{SteadyFit, fit_steady};
