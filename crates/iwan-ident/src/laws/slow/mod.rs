//! What records tell of the slow flow: decay rate and frequency against amplitude, with the covariance of all their errors.

mod grid;
mod windowed;
mod flow;
mod process;
mod linear;
mod measured;
mod between;
mod smooth;

pub use between::Scatter;
pub(super) use between::specimen;
pub(super) use flow::Rates;
pub(super) use grid::Grid;
pub(super) use linear::Information;
pub(super) use measured::{Measured, guess, measure};
pub(super) use process::Covariances;
pub use smooth::Backbone;
pub(super) use smooth::{HALF_WIDTH, Smooth};
pub use windowed::Source;
