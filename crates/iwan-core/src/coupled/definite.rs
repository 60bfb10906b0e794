//! Small symmetric matrices, stored row by row in a slice that the caller provides.

/// Sum of the products of two rows, up to the length of the shorter one.
fn products(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Replaces the lower triangle of a symmetric matrix by its Cholesky factor, of which the diagonal is stored as reciprocals. Returns false
/// if the matrix is not positive definite. Entries above the diagonal are neither read nor changed.
pub(super) fn factorise(order: usize, matrix: &mut [f64]) -> bool {
    for i in 0..order {
        let (done, rest) = matrix.split_at_mut(i * order);
        let row = &mut rest[..=i];
        for (j, other) in done.chunks_exact(order).enumerate() {
            row[j] = (row[j] - products(&row[..j], &other[..j])) * other[j];
        }
        let square = row[i] - products(&row[..i], &row[..i]);
        if !(square > 0.0 && square.is_finite()) {
            return false;
        }
        row[i] = 1.0 / libm::sqrt(square);
    }
    true
}

/// Solves with a factor from [`factorise`]; `x` holds the right-hand side, then the solution.
pub(super) fn solve(order: usize, factor: &[f64], x: &mut [f64]) {
    for (i, row) in factor[..order * order].chunks_exact(order).enumerate() {
        x[i] = (x[i] - products(&row[..i], &x[..i])) * row[i];
    }
    for (i, row) in factor[..order * order].chunks_exact(order).enumerate().rev() {
        let (above, own) = x.split_at_mut(i);
        own[0] *= row[i];
        above.iter_mut().zip(row).for_each(|(x, r)| *x -= r * own[0]);
    }
}

/// Largest eigenvalue of a symmetric, positive semi-definite matrix by the power method. The value serves a message only, so three digits
/// suffice. The start vector is only by accident orthogonal to the eigenvector.
pub(super) fn largest_eigenvalue(order: usize, entry: impl Fn(usize, usize) -> f64, work: &mut [f64]) -> f64 {
    /// Rounds of the power method: with this many, neighbouring eigenvalues 5 % apart are separated to 1 %.
    const ROUNDS: usize = 100;
    let (x, y) = work.split_at_mut(order);
    for (i, x) in x.iter_mut().enumerate() {
        *x = 1.0 + 0.1 * i as f64;
    }
    let mut value = 0.0;
    for _ in 0..ROUNDS {
        for (i, y) in y.iter_mut().take(order).enumerate() {
            *y = x.iter().enumerate().map(|(j, x)| entry(i, j) * x).sum();
        }
        let length = libm::sqrt(y[..order].iter().map(|y| y * y).sum());
        let before = libm::sqrt(x.iter().map(|x| x * x).sum());
        value = length / before;
        if !(length > 0.0 && length.is_finite()) {
            break;
        }
        x.iter_mut().zip(&*y).for_each(|(x, y)| *x = y / length);
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_factor_solves_and_tells_what_is_definite() {
        let mut matrix = [4.0, 0.0, 0.0, 2.0, 5.0, 0.0, -2.0, 1.0, 6.0];
        assert!(factorise(3, &mut matrix));
        // A x for x = (1, -2, 3) with the whole matrix [[4, 2, -2], [2, 5, 1], [-2, 1, 6]].
        let mut x = [-6.0, -5.0, 14.0];
        solve(3, &matrix, &mut x);
        for (x, expected) in x.iter().zip([1.0, -2.0, 3.0]) {
            assert!((x - expected).abs() < 1e-14, "{x}");
        }
        assert!(!factorise(2, &mut [1.0, 0.0, 2.0, 1.0]));
        assert!(!factorise(1, &mut [f64::NAN]));
    }

    #[test]
    fn the_largest_eigenvalue_is_found() {
        // Eigenvalues 1 and 3.
        let value = largest_eigenvalue(2, |i, j| if i == j { 2.0 } else { 1.0 }, &mut [0.0; 4]);
        assert!((value - 3.0).abs() < 1e-12, "{value}");
    }
}
