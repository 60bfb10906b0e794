//! Several modes of several records at once: joints that the modes share, beside modes by themselves and linear modes.
//!
//! The model is that of `iwan_core::CoupledModes`: stuck modes are linear oscillators, and each joint feels the sum of them. Whether modes
//! share a joint is a hypothesis: [`fit_coupled`] fits the models that deny it as well, compares them by Schwarz's criterion on the same records
//! and by what each says of records that it has not seen.

mod records;
mod unknowns;
mod run;
mod series;
mod model;
mod beginning;
mod starts;
mod search;
mod outcome;
mod informed;
mod loads;
mod intervals;
mod fit;

pub use fit::fit_coupled;
pub use outcome::{CoupledCombination, CoupledEstimate, CoupledFit, FittedSharing, Misfit};
pub use records::{CoupledRecord, CoupledTask, Seen, UncoupledMode};
pub use run::between_samples;
pub use series::Sums;
pub use unknowns::{Sharing, Unknown, Values};
