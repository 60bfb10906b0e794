//! Laws compared by evidence, and curves as a model of every record.
//!
//! The slow flow of a ring-down is decay rate λ(a) and frequency ω(a) against amplitude. What records tell about these curves is kept as Gaussian
//! information, with all its correlations, and every law of a short list is fitted to it by averaging. A law may be wrong, so it is fitted together
//! with a discrepancy: a process of ln a whose size is estimated with the parameters. What a law misses widens its intervals and lowers its evidence:
//! laws are compared by the evidence of law and discrepancy together, and the simplest law that is as good as the best is the one to take.

mod slow;
mod mode;
mod terms;
mod candidates;
mod discrepancy;
mod fit;
mod estimates;
mod extrapolation;
mod held_out;
mod together;
mod comparison;

pub use candidates::{CANDIDATES, Candidate};
pub use comparison::{Comparison, compare};
pub use estimates::Estimate;
pub(crate) use extrapolation::Extrapolation;
pub use held_out::HeldOut;
pub use mode::{Joint, LawMode, Rate};
pub use slow::{Backbone, Scatter, Source};
pub use together::FittedLaw;
