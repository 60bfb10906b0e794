//! Systems of a handful of equations, solved in place, for the slips of a few joints.

/// Solves A X = B by Gaussian elimination with row pivoting. A is n by n, row by row; B is n by `columns`, row by row, and is replaced by
/// X. Returns false if A is singular or not finite.
pub(crate) fn solve_small(a: &mut [f64], b: &mut [f64], n: usize, columns: usize) -> bool {
    for k in 0..n {
        let size = |i: &usize| a[i * n + k].abs();
        let Some(pivot) = (k..n).max_by(|i, j| size(i).total_cmp(&size(j))) else { return false };
        let value = a[pivot * n + k];
        if value == 0.0 || !value.is_finite() {
            return false;
        }
        if pivot != k {
            (0..n).for_each(|j| a.swap(k * n + j, pivot * n + j));
            (0..columns).for_each(|j| b.swap(k * columns + j, pivot * columns + j));
        }
        let (done, rest) = a.split_at_mut((k + 1) * n);
        let own = &done[k * n..];
        let (of_done, of_rest) = b.split_at_mut((k + 1) * columns);
        let right = &of_done[k * columns..];
        for (row, of_row) in rest.chunks_exact_mut(n).zip(of_rest.chunks_exact_mut(columns)) {
            let factor = row[k] / own[k];
            if factor != 0.0 {
                row.iter_mut().zip(own).skip(k).for_each(|(x, y)| *x -= factor * y);
                of_row.iter_mut().zip(right).for_each(|(x, y)| *x -= factor * y);
            }
        }
    }
    for k in (0..n).rev() {
        let (above, own) = b.split_at_mut(k * columns);
        let own = &mut own[..columns];
        for x in own.iter_mut() {
            *x /= a[k * n + k];
        }
        for (i, row) in above.chunks_exact_mut(columns).enumerate() {
            let factor = a[i * n + k];
            row.iter_mut().zip(&*own).for_each(|(x, y)| *x -= factor * y);
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::random;

    #[test]
    fn solutions_give_the_right_side_back() {
        for n in 1..9 {
            let (a, b) = (random(n * n, n as u64), random(3 * n, 77));
            let (mut lu, mut x) = (a.clone(), b.clone());
            assert!(solve_small(&mut lu, &mut x, n, 3));
            for i in 0..n {
                for c in 0..3 {
                    let product: f64 = (0..n).map(|j| a[i * n + j] * x[j * 3 + c]).sum();
                    assert!((product - b[i * 3 + c]).abs() < 1e-11, "{n} {i} {c}");
                }
            }
        }
        assert!(!solve_small(&mut [1.0, 2.0, 2.0, 4.0], &mut [1.0, 1.0], 2, 1));
    }
}
