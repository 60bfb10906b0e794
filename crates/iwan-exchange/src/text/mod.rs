//! Matrices as lines of numbers.

pub(crate) mod matrix_market;
pub(crate) mod abaqus;
pub(crate) mod calculix;
pub(crate) mod sierra;
