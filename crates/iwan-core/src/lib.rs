//! Iwan friction models and modal single-degree-of-freedom ring-down, without an allocator.
#![no_std]

mod backbone;
mod energy;
mod error;
mod four_parameter;
mod hysteresis;
mod jenkins;
mod masing;
mod newmark;
mod no_joint;
mod oscillator;
mod plain;
mod power;
mod pulse;
mod events;
mod half_cycle;
mod decay;
mod averaging;
pub mod quadrature;
mod response;
mod runs;
mod slider_newmark;
mod sliders;
mod tabulated;
mod uniform;

pub use averaging::Averaging;
pub use backbone::{Backbone, PowerLaw};
pub use decay::{Decay, TurningPoint};
pub use energy::{EnergyBalance, JointEnergy};
pub use error::Error;
pub use events::EventDriven;
pub use four_parameter::{FourParameter, TabledFourParameter};
pub use hysteresis::Hysteresis;
pub use jenkins::Jenkins;
pub use masing::{Continuum, Reversal, Reversals};
pub use newmark::Newmark;
pub use no_joint::NoJoint;
pub use oscillator::{Oscillator, ResidualStiffness};
pub use plain::{Extensions, Plain};
pub use power::FixedPower;
pub use pulse::Pulse;
pub use response::Samples;
pub use runs::{Run, Runs};
pub use sliders::{Grid, Slider, Sliders};
pub use tabulated::{DensityPoint, Tabulated};
pub use uniform::Uniform;
