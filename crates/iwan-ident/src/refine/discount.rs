//! Residuals discounted for what the model is known to miss: where their covariance is 1 + M Mᵀ in place of 1, they are multiplied by a root of its inverse.
//!
//! Columns of M that belong to a few rows only are discounted in these rows first, and the others behind them: with M = (M₁, M₂) and the root R₁ for M₁, the root for both is that
//! for R₁ M₂, times R₁.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

/// Directions in which M adds less than this part of the noise's variance are left as they are.
const LEAST: f64 = 1e-4;

/// Columns of M that are zero outside some rows. A matrix of those rows has them one range after the other.
#[derive(Debug, Clone)]
pub(super) struct Block {
    pub(super) rows: Vec<Range<usize>>,
    pub(super) columns: DMatrix<f64>,
}

/// The matrix (1 + M Mᵀ)^(-1/2) = 1 - B diag(w) Bᵀ, with orthonormal columns B (`directions`) in some rows and `weights` w.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Root {
    rows: Vec<Range<usize>>,
    directions: DMatrix<f64>,
    weights: DVector<f64>,
}

impl Root {
    /// None where the columns add nothing.
    fn new(Block { rows, columns }: Block) -> Option<Self> {
        let eigen = columns.tr_mul(&columns).symmetric_eigen();
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
        Some(Self { rows, directions, weights: DVector::from_vec(weights) })
    }

    fn apply(&self, matrix: &mut DMatrix<f64>) {
        let mut own = gathered(matrix, &self.rows);
        let mut parts = self.directions.transpose() * &own;
        parts.column_iter_mut().for_each(|mut part| part.component_mul_assign(&self.weights));
        own.gemm(-1.0, &self.directions, &parts, 1.0);
        scatter(&own, &self.rows, matrix);
    }
}

/// The rows of a matrix that lie in `ranges`.
fn gathered(matrix: &DMatrix<f64>, ranges: &[Range<usize>]) -> DMatrix<f64> {
    let mut out = DMatrix::zeros(ranges.iter().map(Range::len).sum(), matrix.ncols());
    let mut to = 0;
    for range in ranges {
        out.rows_mut(to, range.len()).copy_from(&matrix.rows(range.start, range.len()));
        to += range.len();
    }
    out
}

/// Puts rows back where [`gathered`] took them.
fn scatter(rows: &DMatrix<f64>, ranges: &[Range<usize>], matrix: &mut DMatrix<f64>) {
    let mut from = 0;
    for range in ranges {
        matrix.rows_mut(range.start, range.len()).copy_from(&rows.rows(from, range.len()));
        from += range.len();
    }
}

/// A root of the inverse of 1 + M Mᵀ.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Discount(Vec<Root>);

impl Discount {
    /// From the columns of M, in units of the residuals' noise, of which there are `count`; those of few rows first. None where they add nothing.
    pub(super) fn new(count: usize, blocks: Vec<Block>) -> Option<Self> {
        let mut all = Self(vec![]);
        for block in blocks {
            let mut columns = DMatrix::zeros(count, block.columns.ncols());
            scatter(&block.columns, &block.rows, &mut columns);
            all.apply_to_columns(&mut columns);
            let columns = gathered(&columns, &block.rows);
            all.0.extend(Root::new(Block { columns, ..block }));
        }
        (!all.0.is_empty()).then_some(all)
    }

    pub(super) fn apply(&self, r: &mut [f64]) {
        let mut matrix = DMatrix::from_column_slice(r.len(), 1, r);
        self.apply_to_columns(&mut matrix);
        r.copy_from_slice(matrix.as_slice());
    }

    /// Applies the discount to each column of a matrix.
    pub(super) fn apply_to_columns(&self, columns: &mut DMatrix<f64>) {
        self.0.iter().for_each(|root| root.apply(columns));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn discounted_residuals_have_the_covariance_of_noise() {
        let columns =
            |n: usize, by: usize| DMatrix::from_fn(n, 2, |i, j| ((i * (j + by)) as f64).sin() * 3.0);
        // Two rows, four others in two ranges, and all rows.
        let all = || std::iter::once(0..6).collect::<Vec<_>>();
        let blocks = [(vec![1..2, 2..3], 2, 2), (vec![0..1, 3..6], 4, 3), (all(), 6, 5)];
        let block =
            |(rows, n, by): (Vec<Range<usize>>, usize, usize)| Block { rows, columns: columns(n, by) };
        let blocks: Vec<Block> = blocks.into_iter().map(block).collect();
        let mut covariance = DMatrix::identity(6, 6);
        for Block { rows, columns } in &blocks {
            let mut whole = DMatrix::zeros(6, 2);
            scatter(columns, rows, &mut whole);
            covariance += &whole * whole.transpose();
        }
        let discount = Discount::new(6, blocks).unwrap();
        let mut root = DMatrix::identity(6, 6);
        for mut column in root.column_iter_mut() {
            discount.apply(column.as_mut_slice());
        }
        let mut columns = DMatrix::identity(6, 6);
        discount.apply_to_columns(&mut columns);
        assert!((columns - &root).norm() < 1e-14);
        let white = &root * covariance * root.transpose();
        assert!((white - DMatrix::identity(6, 6)).norm() < 1e-12);
        assert!(Discount::new(6, vec![Block { rows: all(), columns: DMatrix::zeros(6, 2) }]).is_none());
    }
}
