//! Small dense matrices, computed on the calling thread.
//!
//! faer's methods and operators follow a setting for the whole process, which is all cores: their threads would spin beside a time step,
//! and a forked process would lack them. The functions here call faer's underlying functions without threads instead.

use faer::diag::Diag;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt;
use faer::linalg::evd::{ComputeEigenvectors, self_adjoint_evd, self_adjoint_evd_scratch};
use faer::linalg::matmul::matmul;
use faer::linalg::svd::{ComputeSvdVectors, svd, svd_scratch};
use faer::{Accum, Mat, MatRef, Par, Spec};

/// Eigenvalues in ascending order, and eigenvectors column by column.
pub(crate) struct Eigen {
    pub(crate) values: Vec<f64>,
    pub(crate) vectors: Mat<f64>,
}

/// Eigenvalues and eigenvectors of a symmetric matrix, given by its lower triangle; none if the matrix is not finite.
///
/// faer leaves errors of the size of the machine precision whatever the size of the matrix, so a matrix with entries of about 1e-6 would
/// lose six digits. Therefore the matrix is scaled to size 1 by a power of two, which rounds nothing, and the eigenvalues are scaled back.
pub(crate) fn symmetric_eigen(matrix: &Mat<f64>) -> Option<Eigen> {
    let (n, spec) = (matrix.nrows(), Spec::default());
    let largest = matrix.norm_max();
    let size = if largest > 0.0 && largest.is_finite() { largest.log2().floor().exp2() } else { 1.0 };
    let matrix = Mat::from_fn(n, n, |i, j| matrix[(i, j)] / size);
    let (mut values, mut vectors) = (Diag::zeros(n), Mat::zeros(n, n));
    let mut buffer =
        MemBuffer::new(self_adjoint_evd_scratch::<f64>(n, ComputeEigenvectors::Yes, Par::Seq, spec));
    let stack = MemStack::new(&mut buffer);
    self_adjoint_evd(matrix.as_ref(), values.as_mut(), Some(vectors.as_mut()), Par::Seq, stack, spec).ok()?;
    Some(Eigen { values: values.column_vector().iter().map(|value| value * size).collect(), vectors })
}

/// Singular values in descending order, left and right singular vectors column by column; none if the matrix is not finite.
pub(crate) fn thin_svd(matrix: &Mat<f64>) -> Option<(Vec<f64>, Mat<f64>, Mat<f64>)> {
    let (m, n, spec) = (matrix.nrows(), matrix.ncols(), Spec::default());
    let size = m.min(n);
    let (mut values, mut left, mut right) = (Diag::zeros(size), Mat::zeros(m, size), Mat::zeros(n, size));
    let thin = ComputeSvdVectors::Thin;
    let mut buffer = MemBuffer::new(svd_scratch::<f64>(m, n, thin, thin, Par::Seq, spec));
    let stack = MemStack::new(&mut buffer);
    let (u, v) = (Some(left.as_mut()), Some(right.as_mut()));
    svd(matrix.as_ref(), values.as_mut(), u, v, Par::Seq, stack, spec).ok()?;
    Some((values.column_vector().iter().copied().collect(), left, right))
}

/// Inverse of a symmetric positive definite matrix, given by its lower triangle; none if the matrix is not positive definite.
pub(crate) fn positive_inverse(mut matrix: Mat<f64>) -> Option<Mat<f64>> {
    let (n, spec) = (matrix.nrows(), Spec::default());
    let mut buffer = MemBuffer::new(llt::factor::cholesky_in_place_scratch::<f64>(n, Par::Seq, spec));
    let none = llt::factor::LltRegularization::default();
    llt::factor::cholesky_in_place(matrix.as_mut(), none, Par::Seq, MemStack::new(&mut buffer), spec).ok()?;
    let mut inverse = Mat::identity(n, n);
    llt::solve::solve_in_place(matrix.as_ref(), inverse.as_mut(), Par::Seq, MemStack::new(&mut buffer));
    // The upper triangle is copied from the lower one, so that rounding leaves no asymmetry.
    Some(Mat::from_fn(n, n, |i, j| inverse[(i.max(j), i.min(j))]))
}

/// The product A B.
pub(crate) fn product(a: MatRef<'_, f64>, b: MatRef<'_, f64>) -> Mat<f64> {
    let mut out = Mat::zeros(a.nrows(), b.ncols());
    matmul(&mut out, Accum::Replace, a, b, 1.0, Par::Seq);
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn largest(matrix: &Mat<f64>) -> f64 {
        matrix.norm_max()
    }

    /// Matrices of very small and very large entries keep as many digits as others.
    #[test]
    fn the_size_of_a_matrix_does_not_matter() {
        // Large enough for the divide-and-conquer method, in which the digits would be lost.
        let n = 240;
        // Eigenvalues over twelve decades, with eigenvectors mixed by a reflection.
        let w: Vec<f64> = (0..n).map(|i| 1.0 + (i as f64).sin()).collect();
        let norm: f64 = w.iter().map(|w| w * w).sum();
        let value = |i: usize| 10.0_f64.powf(-12.0 * i as f64 / n as f64);
        let reflect = |i: usize, j: usize| f64::from(u8::from(i == j)) - 2.0 * w[i] * w[j] / norm;
        let q = Mat::from_fn(n, n, reflect);
        let scaled = Mat::from_fn(n, n, |i, j| q[(i, j)] * value(j));
        let plain = product(scaled.as_ref(), q.transpose());
        for size in [1e-9, 1.0, 1e9] {
            let a = Mat::from_fn(n, n, |i, j| size * plain[(i.max(j), i.min(j))]);
            let Eigen { values, vectors } = symmetric_eigen(&a).unwrap();
            let scaled = Mat::from_fn(n, n, |i, j| vectors[(i, j)] * values[j]);
            let residual = product(a.as_ref(), vectors.as_ref()) - scaled;
            assert!(largest(&residual) < 1e-13 * size, "{size:e} {:e}", largest(&residual));
        }
    }

    #[test]
    fn factors_give_the_matrix_back() {
        let n = 9;
        let a = Mat::from_fn(n, n, |i, j| 1.0 / (1.0 + (i + j) as f64) + if i == j { 1.0 } else { 0.0 });
        let Eigen { values, vectors } = symmetric_eigen(&a).unwrap();
        assert!(values.windows(2).all(|v| v[0] <= v[1]));
        let scaled = Mat::from_fn(n, n, |i, j| vectors[(i, j)] * values[j]);
        assert!(largest(&(product(scaled.as_ref(), vectors.transpose()) - &a)) < 1e-14);
        let inverse = positive_inverse(a.clone()).unwrap();
        assert!(largest(&(product(a.as_ref(), inverse.as_ref()) - Mat::<f64>::identity(n, n))) < 1e-14);
        assert_eq!(inverse, inverse.transpose().to_owned());
        let tall = a.subcols(0, 4).to_owned();
        let (singular, left, right) = thin_svd(&tall).unwrap();
        let scaled = Mat::from_fn(n, 4, |i, j| left[(i, j)] * singular[j]);
        assert!(largest(&(product(scaled.as_ref(), right.transpose()) - &tall)) < 1e-14);
        assert!(positive_inverse(Mat::from_fn(2, 2, |i, j| if i == j { -1.0 } else { 0.0 })).is_none());
    }
}
