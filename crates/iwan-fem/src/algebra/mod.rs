//! Vectors and matrices, small and dense, large and sparse. The module does not know what the unknowns mean.

mod lanes;
mod workers;
mod random;
mod dense;
mod small;
mod sparse;
mod nodal_product;
mod ordering;
mod triangular;
mod factor;
mod eigen;

pub(crate) use dense::{positive_inverse, product, symmetric_eigen, thin_svd};
pub(crate) use eigen::{Pairs, Problem};
pub(crate) use factor::{Analysis, Cholesky};
pub(crate) use iwan_core::search_line;
pub(crate) use lanes::{Group, LANES, grouped, total};
pub(crate) use nodal_product::NodalProduct;
pub(crate) use ordering::Site;
#[cfg(test)]
pub(crate) use random::random;
pub(crate) use small::solve_small;
pub use sparse::Symmetric;
pub(crate) use sparse::{add_scaled, dot, largest, scale};
