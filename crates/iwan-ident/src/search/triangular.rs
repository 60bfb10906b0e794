//! Triangular factors of matrices by blocked Householder reflections.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::qr::no_pivoting::factor as qr;
use faer::{Col, Mat, MatMut, Par, Spec};
use iwan_machine::memory::is_address_space_bounded;
use nalgebra::DMatrix;

/// The triangular factor R of the QR decomposition of a matrix.
pub(crate) fn triangular(mut matrix: DMatrix<f64>) -> DMatrix<f64> {
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
