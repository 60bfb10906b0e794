//! Joint laws: a law is its virgin curve, from which Masing's rule makes everything else.

mod backbone;
mod jenkins;
mod uniform;
mod tabulated;
mod four_parameter;
mod slopes;
mod power;
mod tabled_four_parameter;
mod representation;

pub use backbone::{Backbone, PowerLaw};
pub use four_parameter::FourParameter;
pub use jenkins::Jenkins;
pub(crate) use jenkins::jenkins_harmonic;
pub use power::FixedPower;
pub use representation::{Grid, Representation};
pub use slopes::LawSlopes;
pub use tabled_four_parameter::TabledFourParameter;
pub use tabulated::{DensityPoint, Tabulated};
pub use uniform::Uniform;
