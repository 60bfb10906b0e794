//! Parameters found on curves of dissipation and frequency, and how far off the model is.

mod start;
mod verdict;
mod averaged;

pub(crate) use averaged::{DISSIPATION_FLOOR, FREQUENCY_FLOOR};
pub use averaged::{Fit, Predicted, fit, fit_from, predict};
pub use start::{Start, beta_root, start};
pub(crate) use verdict::{Beside, Compared, DISSIPATION, Doubt, Pairs, left_over};
pub use verdict::{Grade, Verdict};
