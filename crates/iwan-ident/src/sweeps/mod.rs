//! Parameters of a mode from a shaker's test: stepped-sine responses and phase-resonance backbones, alone or together with ring-downs.

mod data;
mod balance;
mod task;
mod start;
mod region;
mod intervals;
mod fit;

pub use data::{BackbonePoint, ResponsePoint, SteadyData};
pub use fit::{SteadyFit, fit_steady};
