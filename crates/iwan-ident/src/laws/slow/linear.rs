//! Gaussian information about curves: rows z = R c + e with independent errors of variance 1.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// Part of the largest eigenvalue below which a direction counts as unknown: its standard deviation is then thirty thousand times that of the
/// best-known direction, and rounding is all that it holds.
const LEAST: f64 = 1e-9;

/// What records tell about the values of curves on a grid, decay rates first, then circular frequencies.
#[derive(Debug, Clone)]
pub(crate) struct Information {
    /// The matrix R, one row for each direction that is known at all.
    pub(crate) factor: DMatrix<f64>,
    /// The observed values z, one per row.
    pub(crate) target: DVector<f64>,
}

impl Information {
    /// From the log-likelihood -½ δᵀN δ + gᵀδ, where δ is the distance of the curves from `about`, N the `matrix` and g the `gradient`.
    pub(crate) fn new(matrix: DMatrix<f64>, gradient: &DVector<f64>, about: &DVector<f64>) -> Self {
        let eigen = SymmetricEigen::new(matrix);
        let most = eigen.eigenvalues.max();
        let known: Vec<usize> =
            (0..eigen.eigenvalues.len()).filter(|&i| eigen.eigenvalues[i] > LEAST * most).collect();
        let mut factor = DMatrix::zeros(known.len(), gradient.len());
        let mut target = DVector::zeros(known.len());
        for (row, &i) in known.iter().enumerate() {
            let (root, vector) = (eigen.eigenvalues[i].sqrt(), eigen.eigenvectors.column(i));
            factor.row_mut(row).copy_from(&(vector.transpose() * root));
            target[row] = root * vector.dot(about) + vector.dot(gradient) / root;
        }
        Self { factor, target }
    }

    /// The information of several records together.
    pub(crate) fn sum(all: &[Self]) -> Self {
        if let [one] = all {
            return one.clone();
        }
        let unknowns = all.first().map_or(0, |one| one.factor.ncols());
        let mut matrix = DMatrix::zeros(unknowns, unknowns);
        for one in all {
            matrix += one.factor.transpose() * &one.factor;
        }
        // Sums of Rᵀz, so that nothing cancels: N c = Σ Rᵀz.
        let mut gradient = DVector::zeros(unknowns);
        for one in all {
            gradient += one.factor.transpose() * &one.target;
        }
        Self::new(matrix, &gradient, &DVector::zeros(unknowns))
    }
}

/// The matrix N with the last `count` unknowns integrated out, and the gradient with them; none where N does not determine these unknowns.
pub(crate) fn without_last(
    matrix: &DMatrix<f64>,
    gradient: &DVector<f64>,
    count: usize,
) -> Option<(DMatrix<f64>, DVector<f64>)> {
    let kept = matrix.nrows() - count;
    let inner = matrix.view((kept, kept), (count, count)).into_owned().cholesky()?;
    let across = matrix.view((0, kept), (kept, count)).into_owned();
    let carried = inner.solve(&across.transpose());
    let left = matrix.view((0, 0), (kept, kept)) - &across * carried;
    let gradient_left =
        gradient.rows(0, kept) - across * inner.solve(&gradient.rows(kept, count).into_owned());
    Some((left, gradient_left))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_told_of_two_unknowns_through_a_third() {
        // c0 + n, c1 + n and n itself are observed, each with variance 1: without n the first two have variance 2 and covariance 1.
        let rows = DMatrix::from_row_slice(3, 3, &[1.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0]);
        let observed = DVector::from_row_slice(&[3.0, 5.0, 0.5]);
        let (matrix, gradient) = (rows.transpose() * &rows, rows.transpose() * &observed);
        let (n, g) = without_last(&matrix, &gradient, 1).unwrap();
        let covariance = n.clone().try_inverse().unwrap();
        assert!((covariance - DMatrix::from_row_slice(2, 2, &[2.0, 1.0, 1.0, 2.0])).norm() < 1e-12);
        let about = DVector::zeros(2);
        let information = Information::new(n, &g, &about);
        let solved = information.factor.clone().try_inverse().unwrap() * &information.target;
        assert!((solved - DVector::from_row_slice(&[2.5, 4.5])).norm() < 1e-12);
        // Twice the same: half the variance, the same estimate.
        let twice = Information::sum(&[information.clone(), information]);
        let solved = twice.factor.clone().try_inverse().unwrap() * &twice.target;
        assert!((solved - DVector::from_row_slice(&[2.5, 4.5])).norm() < 1e-12);
        let covariance = (twice.factor.transpose() * &twice.factor).try_inverse().unwrap();
        assert!((covariance[(0, 0)] - 1.0).abs() < 1e-12);
    }
}
