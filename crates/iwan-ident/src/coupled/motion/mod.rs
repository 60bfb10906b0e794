//! What a record would show by the model: time steps, samples between them, and what is compared of these.

mod between;
mod run;
mod series;

pub(super) use between::at_samples;
pub use between::between_samples;
pub(super) use run::{Clock, Motions, populations, room, run, run_with};
pub use series::Sums;
pub(super) use series::amplitude;
