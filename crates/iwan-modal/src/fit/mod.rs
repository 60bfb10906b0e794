//! The fit of all poles together to all responses: maximum likelihood for white noise on the responses.
//!
//! The poles are the only unknowns of the search; residues follow from them by linear least squares (variable projection: G. H. Golub,
//! V. Pereyra, SIAM J. Numer. Anal. 10:413, 1973, with Kaufman's Jacobian, BIT 15:49, 1975). The model is that of the finite record
//! (see [`FiniteRecord`](crate::responses::FiniteRecord)), so that no window is needed.

mod outside;
mod band;
mod columns;
mod linear;
mod certainty;
mod search;
mod worth;

pub(crate) use band::{Band, at};
pub use certainty::Certainty;
pub(crate) use linear::Linear;
pub(crate) use search::left_over;
pub use search::{Fitted, fit};
pub(crate) use worth::{least_worth, pruned, twins, worth};
