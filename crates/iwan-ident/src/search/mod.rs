//! Searches: the coordinates in which parameters are sought, and least squares between bounds.

mod chart;
mod kept;
mod triangular;
mod least_squares;
mod non_negative;

pub(crate) use chart::{CHI, Chart, DAMPING, DIRAC, FREQUENCY, KNEE, SOFTENING, Scales};
pub(crate) use kept::Kept;
pub(crate) use least_squares::{LARGE_GROWTH, Minimum, Problem, Search, Sooner, TOLERANCE, following};
pub(crate) use non_negative::solve as solve_non_negative;
pub(crate) use triangular::blocked;
