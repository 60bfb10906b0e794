//! Triangular factors of matrices, by the products of columns that lie apart and by Householder reflections.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::qr::no_pivoting::factor as qr;
use faer::{Col, Mat, MatMut, Par, Spec};
use iwan_machine::memory::is_address_space_bounded;
use nalgebra::{DMatrix, DVector};

/// Number of unknowns from which on triangular factors are made by blocks: fits of a dozen records have fifty, and factors made column by column were
/// more than a tenth of their time. For the dozen unknowns of one record or a law they are less than a hundredth.
const BLOCKED: usize = 24;
/// Least sine of the angle between a column and the space of those before it with which triangular factors are made of the columns' products: nine digits of the factor are right then.
const APART: f64 = 1e-3;

/// The triangular factor of a matrix with no fewer rows than columns, and the part of the right side that the matrix reaches, both turned by the same
/// rotation: the least squares of the one against the other are those of the matrix against the right side.
pub(super) fn rotated(matrix: &DMatrix<f64>, right: &DVector<f64>) -> (DMatrix<f64>, DVector<f64>) {
    let columns = matrix.ncols();
    if columns < BLOCKED {
        let factors = matrix.clone().qr();
        let mut turned = right.clone();
        factors.q_tr_mul(&mut turned);
        return (factors.r(), turned.rows(0, columns).into_owned());
    }
    let mut beside = matrix.clone().resize_horizontally(columns + 1, 0.0);
    beside.set_column(columns, right);
    let factor = by_products(&beside).unwrap_or_else(|| triangular(beside));
    (
        factor.view((0, 0), (columns, columns)).into_owned(),
        factor.view((0, columns), (columns, 1)).column(0).into_owned(),
    )
}

/// The triangular factor from the products of the columns, which are made faster than reflections. From the first column on that lies next to the space of those before it, what lies
/// outside of that space is taken by reflections: products lose as many digits again as columns have in common. None where these are most of the columns.
fn by_products(matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let ((rows, columns), across) = (matrix.shape(), matrix.transpose());
    let mut products = &across * matrix;
    // A column without any effect lies next to every space.
    let norms = products.diagonal().map(|square| square.sqrt().max(f64::MIN_POSITIVE));
    for (mut column, norm) in products.column_iter_mut().zip(&norms) {
        column.component_div_assign(&norms);
        column.unscale_mut(*norm);
    }
    let (lower, apart) = leading_factor(products);
    if 2 * apart < columns {
        return None;
    }
    let mut factor = DMatrix::zeros(columns, columns);
    factor.rows_mut(0, apart).copy_from(&lower.columns(0, apart).transpose());
    if apart < columns {
        let first = lower.view((0, 0), (apart, apart));
        let others = columns - apart;
        let mut outside = matrix.columns(apart, others).into_owned();
        outside
            .column_iter_mut()
            .zip(norms.rows(apart, others).iter())
            .for_each(|(mut c, n)| c.unscale_mut(*n));
        let mut inside = factor.view((0, apart), (apart, others)).into_owned();
        // What is taken off by products is off by rounding: the second time takes off what the first one left.
        for again in [false, true] {
            if again {
                let mut left = across.rows(0, apart) * &outside;
                left.column_iter_mut().for_each(|mut c| c.component_div_assign(&norms.rows(0, apart)));
                first.solve_lower_triangular_unchecked_mut(&mut left);
                inside = left;
                let mut known = factor.view_mut((0, apart), (apart, others));
                known += &inside;
            }
            let mut parts = inside.clone();
            first.tr_solve_lower_triangular_unchecked_mut(&mut parts);
            parts.column_iter_mut().for_each(|mut c| c.component_div_assign(&norms.rows(0, apart)));
            outside.gemm(-1.0, &matrix.columns(0, apart), &parts, 1.0);
        }
        let reflected = outside.qr().unpack_r();
        let known = rows.min(others);
        factor.view_mut((apart, apart), (known, others)).copy_from(&reflected.rows(0, known));
    }
    factor.fill_lower_triangle(0.0, 1);
    factor.column_iter_mut().zip(&norms).for_each(|(mut column, norm)| column.scale_mut(*norm));
    Some(factor)
}

/// The lower triangular factor of products of columns of length one, and the number of its leading columns that were made: up to the first one that is not `APART` from those before it.
fn leading_factor(mut products: DMatrix<f64>) -> (DMatrix<f64>, usize) {
    let n = products.ncols();
    for j in 0..n {
        let square = products[(j, j)];
        if square < APART * APART {
            return (products, j);
        }
        let below = n - j;
        let mut column = products.view_mut((j, j), (below, 1));
        column.unscale_mut(square.sqrt());
        let column = column.into_owned();
        for (k, part) in column.iter().enumerate().skip(1) {
            let mut later = products.view_mut((j + k, j + k), (below - k, 1));
            later.zip_apply(&column.rows(k, below - k), |entry, own| *entry -= part * own);
        }
    }
    (products, n)
}

/// The triangular factor R of the QR decomposition of a matrix.
fn triangular(mut matrix: DMatrix<f64>) -> DMatrix<f64> {
    if is_address_space_bounded() {
        return matrix.qr().unpack_r();
    }
    let ((rows, columns), spec) = (matrix.shape(), Spec::default());
    let block = qr::recommended_block_size::<f64>(rows, columns);
    let mut coefficients = Mat::zeros(block, rows.min(columns));
    let mut buffer = MemBuffer::new(qr::qr_in_place_scratch::<f64>(rows, columns, block, Par::Seq, spec));
    let stack = MemStack::new(&mut buffer);
    qr::qr_in_place(blocked(&mut matrix), coefficients.as_mut(), Par::Seq, stack, spec);
    put_wide_registers_away();
    let mut factor = matrix.resize_vertically(rows.min(columns), 0.0);
    factor.fill_lower_triangle(0.0, 1);
    factor
}

/// The reflections leave the upper halves of the processor's wide registers in use (faer 0.24; products, Cholesky and LU factors do not). Every call of
/// the C library's exp, sin or log takes thirty times as long from then on, and so did ring-downs between two factorisations. A norm ends with the
/// instruction that puts the registers away.
fn put_wide_registers_away() {
    std::hint::black_box(Col::<f64>::full(16, 1.0).norm_l2());
}

/// The view of a matrix that blocked factorisations take. For a dozen records matrices have several hundred rows and columns, where blocked
/// factorisations are four to ten times as fast as plain ones.
pub(crate) fn blocked(matrix: &mut DMatrix<f64>) -> MatMut<'_, f64> {
    let (rows, columns) = matrix.shape();
    MatMut::from_column_major_slice_mut(matrix.as_mut_slice(), rows, columns)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The factor with a positive diagonal, which is the same whatever made it.
    fn upright(mut factor: DMatrix<f64>) -> DMatrix<f64> {
        for (i, mut row) in factor.row_iter_mut().enumerate() {
            row *= row[i].signum();
        }
        factor
    }

    #[test]
    fn factors_by_products_are_those_by_reflections() {
        let columns =
            |i: usize, j: usize| ((i * i + 3 * i * j + j * j * j) as f64).sin() * (j as f64 - 14.5).exp();
        let mut matrix = DMatrix::from_fn(200, 30, columns);
        let close = |matrix: &DMatrix<f64>, part: f64| {
            let (found, exact) = (upright(by_products(matrix).unwrap()), upright(triangular(matrix.clone())));
            for j in 0..30 {
                assert!((found.row(j) - exact.row(j)).norm() < part * exact.row(j).norm(), "{j}");
            }
        };
        close(&matrix, 1e-12);
        // Nine digits are left where a column lies as near to others as it may, and more digits than that where the columns that lie nearer are last.
        let length = |matrix: &DMatrix<f64>, j: usize| matrix.column(j) / matrix.column(j).norm();
        let apart = length(&matrix, 29) * (2.0 * APART);
        matrix.set_column(29, &(length(&matrix, 3) + &apart));
        close(&matrix, 1e-9);
        let other = DVector::from_fn(200, |i, _| 1e-4 * (0.7 * (i * i) as f64).cos());
        for nearer in [1.0, 1e-1, 1e-2] {
            matrix.set_column(28, &(length(&matrix, 4) + &apart * (0.1 * nearer)));
            matrix.set_column(29, &(length(&matrix, 3) + &other * nearer));
            close(&matrix, 1e-9);
        }
        matrix.fill_column(27, 0.0);
        let (found, exact) = (by_products(&matrix).unwrap(), triangular(matrix.clone()));
        assert!((found.tr_mul(&found) - exact.tr_mul(&exact)).norm() < 1e-13 * exact.norm_squared());
        assert!(found.column(27).norm() == 0.0);
        // Where most columns lie near to others, all are reflected.
        matrix.set_column(5, &(length(&matrix, 4) + &apart * 0.1));
        assert!(by_products(&matrix).is_none());
    }

    #[test]
    fn right_sides_are_turned_with_the_matrix() {
        for columns in [3, 30] {
            let matrix =
                DMatrix::from_fn(200, columns, |i, j| ((i * i + 3 * i * j + j * j * j) as f64).sin());
            let right = DVector::from_fn(200, |i, _| (0.3 * i as f64).cos());
            let (factor, turned) = rotated(&matrix, &right);
            assert!((factor.tr_mul(&turned) - matrix.tr_mul(&right)).norm() < 1e-12 * right.norm());
            assert!((factor.tr_mul(&factor) - matrix.tr_mul(&matrix)).norm() < 1e-11);
            // A right side that the matrix reaches leaves nothing.
            let (factor, turned) = rotated(&matrix, &(&matrix * DVector::repeat(columns, 1.0)));
            assert!((turned - factor * DVector::repeat(columns, 1.0)).norm() < 1e-11);
        }
    }

    #[test]
    fn triangular_factors_are_those_of_the_matrix() {
        for (rows, columns) in [(7, 3), (300, 140), (5, 5), (4, 6)] {
            let matrix = DMatrix::from_fn(rows, columns, |i, j| ((3 * i + 7 * j * j) as f64).sin());
            let factor = triangular(matrix.clone());
            assert!((factor.tr_mul(&factor) - matrix.tr_mul(&matrix)).norm() < 1e-13 * matrix.norm_squared());
        }
        let without_effect = DMatrix::from_row_slice(3, 2, &[0.0, 1.0, 0.0, 2.0, 0.0, 2.0]);
        let factor = triangular(without_effect);
        assert!(factor.column(0).norm() == 0.0 && (factor.column(1).norm() - 3.0).abs() < 1e-15);
    }
}
