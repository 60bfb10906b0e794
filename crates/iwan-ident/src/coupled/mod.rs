//! Several modes of several records at once: modes that share joints, beside modes with joints of their own and linear modes.
//!
//! The model is that of `iwan_core::CoupledModes`: stuck modes are linear oscillators, and the slip of each joint is a weighted sum of their displacements. Whether modes
//! share a joint is a hypothesis. So [`fit_coupled`] also fits the models without shared joints, and compares all of them by Schwarz's criterion on the same records
//! and by how well each predicts records that were kept out of the fit.

mod records;
mod unknowns;
mod motion;
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
pub use motion::{Sums, between_samples};
pub use outcome::{CoupledCombination, CoupledEstimate, CoupledFit, FittedSharing, Misfit};
pub use records::{CoupledRecord, CoupledTask, Seen, UncoupledMode};
pub use unknowns::{Sharing, Unknown, Values};
