//! Joint laws. A law is given by its virgin curve, from which Masing's rule gives all loops. Where friction drops once a slider slips, the
//! rule does not hold and the cycles are derived slider by slider.

mod backbone;
mod jenkins;
mod uniform;
mod tabulated;
mod cosine_moment;
mod four_parameter;
mod breakaway;
mod five_parameter;
mod slopes;
mod power;
mod tabled_four_parameter;
mod representation;

pub(crate) use backbone::check_masing;
pub use backbone::{Backbone, PowerLaw};
pub(crate) use breakaway::Breakaway;
pub use five_parameter::FiveParameter;
pub use four_parameter::FourParameter;
pub use jenkins::Jenkins;
pub(crate) use jenkins::jenkins_harmonic;
pub use power::FixedPower;
pub use representation::{Grid, Representation};
pub use slopes::LawSlopes;
pub use tabled_four_parameter::TabledFourParameter;
pub use tabulated::{DensityPoint, Tabulated};
pub use uniform::Uniform;
