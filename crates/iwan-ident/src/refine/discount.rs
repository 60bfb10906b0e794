//! Residuals discounted for what the model is known to miss: where their covariance is 1 + M Mᵀ in place of 1, they are multiplied by its inverse
//! square root.

use nalgebra::{DMatrix, DVector, DVectorViewMut};
use serde::{Deserialize, Serialize};

/// Directions in which M adds less than this part of the noise's variance are left as they are.
const LEAST: f64 = 1e-4;

/// The matrix (1 + M Mᵀ)^(-1/2) = 1 - B diag(w) Bᵀ, with orthonormal columns B (`directions`) and `weights` w.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Discount {
    directions: DMatrix<f64>,
    weights: DVector<f64>,
}

impl Discount {
    /// From the columns of M, in units of the residuals' noise; none where they add nothing.
    pub(super) fn new(columns: &DMatrix<f64>) -> Option<Self> {
        let eigen = columns.tr_mul(columns).symmetric_eigen();
        let kept: Vec<usize> =
            (0..eigen.eigenvalues.len()).filter(|i| eigen.eigenvalues[*i] > LEAST).collect();
        if kept.is_empty() {
            return None;
        }
        let mut directions = columns * eigen.eigenvectors.select_columns(&kept);
        let mut weights = vec![];
        for (k, &i) in kept.iter().enumerate() {
            directions.column_mut(k).scale_mut(1.0 / eigen.eigenvalues[i].sqrt());
            weights.push(1.0 - 1.0 / (1.0 + eigen.eigenvalues[i]).sqrt());
        }
        Some(Self { directions, weights: DVector::from_vec(weights) })
    }

    pub(super) fn apply(&self, r: &mut [f64]) {
        let count = r.len();
        let mut r = DVectorViewMut::from_slice(r, count);
        let parts = self.directions.tr_mul(&r).component_mul(&self.weights);
        r.gemv(-1.0, &self.directions, &parts, 1.0);
    }

    /// Applies the discount to each column of a matrix.
    pub(super) fn apply_to_columns(&self, columns: &mut DMatrix<f64>) {
        let mut parts = self.directions.tr_mul(columns);
        parts.column_iter_mut().for_each(|mut part| part.component_mul_assign(&self.weights));
        columns.gemm(-1.0, &self.directions, &parts, 1.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn discounted_residuals_have_the_covariance_of_noise() {
        let columns = DMatrix::from_fn(6, 2, |i, j| ((i * (j + 2)) as f64).sin() * 3.0);
        let covariance = DMatrix::identity(6, 6) + &columns * columns.transpose();
        let discount = Discount::new(&columns).unwrap();
        let mut root = DMatrix::identity(6, 6);
        for mut column in root.column_iter_mut() {
            discount.apply(column.as_mut_slice());
        }
        let mut columns = DMatrix::identity(6, 6);
        discount.apply_to_columns(&mut columns);
        assert!((columns - &root).norm() < 1e-14);
        let white = &root * covariance * root.transpose();
        assert!((white - DMatrix::identity(6, 6)).norm() < 1e-12);
        assert!(Discount::new(&DMatrix::zeros(6, 2)).is_none());
    }
}
