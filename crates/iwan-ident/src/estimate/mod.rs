//! Estimates of the unknowns of any model that brings its derivatives: least squares between bounds, profile likelihood, and how certain combinations are.
//!
//! These are the searches and walks that identify a mode ([`profile`](mod@crate::profile)), for models that this crate does not know: the joints
//! of a structure, or modes that share joints.

mod model;
mod minimum;
mod told;
mod clusters;
mod profiles;

pub use crate::student::student_quantile;
pub use clusters::widening;
pub use minimum::{Found, Weights, least, near};
pub use model::Model;
pub(crate) use model::Squares;
pub(crate) use profiles::Profiles;
pub use profiles::{About, Interval, intervals};
pub use told::{Combination, Told, silent};
