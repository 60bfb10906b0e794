//! Smooth curves through noisy points, with slopes and their standard deviations.

mod points;
mod polynomial;
mod spline;
mod local;

pub(crate) use local::LocalFit;
pub(crate) use points::{Points, Smooth};
pub(crate) use polynomial::Polynomial;
pub(crate) use spline::Spline;
