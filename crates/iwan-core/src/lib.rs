//! Iwan friction models and modal single-degree-of-freedom ring-down, without an allocator.
#![no_std]

mod backbone;
mod error;
mod four_parameter;
mod hysteresis;
mod jenkins;
mod masing;
mod plain;
mod power;
pub mod quadrature;
mod runs;
mod sliders;
mod tabulated;
mod uniform;

pub use backbone::{Backbone, PowerLaw};
pub use error::Error;
pub use four_parameter::{FourParameter, TabledFourParameter};
pub use hysteresis::Hysteresis;
pub use jenkins::Jenkins;
pub use masing::{Continuum, Reversal, Reversals};
pub use plain::{Extensions, Plain};
pub use power::FixedPower;
pub use runs::{Run, Runs};
pub use sliders::{Grid, Slider, Sliders};
pub use tabulated::{DensityPoint, Tabulated};
pub use uniform::Uniform;
