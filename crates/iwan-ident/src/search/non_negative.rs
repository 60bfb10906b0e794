//! Least squares with non-negative unknowns, by the active-set method of Lawson and Hanson on the normal equations
//! (C. L. Lawson, R. J. Hanson, *Solving Least Squares Problems*, 1974, ch. 23; R. Bro, S. de Jong, J. Chemometrics 11,
//! 393, 1997, doi:10.1002/(SICI)1099-128X(199709/10)11:5<393::AID-CEM483>3.0.CO;2-L).
//!
//! This is written here because ready-made solvers bring a second linear algebra with them, and cannot go on from the solution of a neighbouring
//! problem, which a search for a regularisation does all the time.

use nalgebra::{DMatrix, DVector};

/// Part of the largest right-hand side below which a gradient counts as zero: ten thousand times rounding. A larger value would leave out unknowns
/// that the solution has, a smaller one would let them come and go for ever.
const TOLERANCE: f64 = 1e-11;

/// The least x'Hx/2 - b'x over x >= 0 for a symmetric positive definite H [n × n]. The search begins with the unknowns in `positive` above zero, and
/// brings that set up to date. None when H is not positive definite, or rounding keeps the search going for more than 10 n rounds.
pub(crate) fn solve(h: &DMatrix<f64>, b: &DVector<f64>, positive: &mut Vec<bool>) -> Option<DVector<f64>> {
    let n = b.len();
    positive.resize(n, false);
    let mut x = feasible(h, b, positive)?;
    let limit = TOLERANCE * b.amax();
    for _ in 0..10 * n {
        let gradient = b - h * &x;
        let zero = (0..n).filter(|&i| !positive[i]);
        let Some(best) = zero.max_by(|&i, &j| gradient[i].total_cmp(&gradient[j])) else { return Some(x) };
        if gradient[best] <= limit {
            return Some(x);
        }
        positive[best] = true;
        x = descend(h, b, x, positive)?;
    }
    None
}

/// A start: the solution on the set of positive unknowns, from which those that came out negative have been dropped.
fn feasible(h: &DMatrix<f64>, b: &DVector<f64>, positive: &mut [bool]) -> Option<DVector<f64>> {
    loop {
        let x = on_set(h, b, positive)?;
        let mut dropped = false;
        for i in 0..b.len() {
            if positive[i] && x[i] <= 0.0 {
                positive[i] = false;
                dropped = true;
            }
        }
        if !dropped {
            return Some(x);
        }
    }
}

/// Goes from `x` towards the solution on the set, and drops the unknowns that reach zero on the way.
fn descend(
    h: &DMatrix<f64>,
    b: &DVector<f64>,
    mut x: DVector<f64>,
    positive: &mut [bool],
) -> Option<DVector<f64>> {
    loop {
        let target = on_set(h, b, positive)?;
        let blocking = (0..b.len()).filter(|&i| positive[i] && target[i] <= 0.0);
        let step = blocking.map(|i| (x[i] / (x[i] - target[i]), i)).min_by(|a, b| a.0.total_cmp(&b.0));
        let Some((share, first)) = step else { return Some(target) };
        x += share.max(0.0) * (&target - &x);
        for i in 0..b.len() {
            if positive[i] && (i == first || x[i] <= 0.0) {
                positive[i] = false;
                x[i] = 0.0;
            }
        }
    }
}

/// The unconstrained solution on the unknowns of the set, with the others zero.
fn on_set(h: &DMatrix<f64>, b: &DVector<f64>, positive: &[bool]) -> Option<DVector<f64>> {
    let set: Vec<usize> = (0..b.len()).filter(|&i| positive[i]).collect();
    let mut x = DVector::zeros(b.len());
    if set.is_empty() {
        return Some(x);
    }
    let part = DMatrix::from_fn(set.len(), set.len(), |i, j| h[(set[i], set[j])]);
    let found = part.cholesky()?.solve(&DVector::from_iterator(set.len(), set.iter().map(|&i| b[i])));
    set.iter().zip(found.iter()).for_each(|(&i, value)| x[i] = *value);
    Some(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_would_be_negative_is_zero() {
        // min (x - 1)² + (y + 2)² and a coupled problem with the corner solution x = 1.5, y = 0.
        let (h, b) = (DMatrix::identity(2, 2), DVector::from_vec(vec![1.0, -2.0]));
        assert_eq!(solve(&h, &b, &mut vec![]).unwrap().as_slice(), [1.0, 0.0]);
        let h = DMatrix::from_row_slice(2, 2, &[2.0, 1.0, 1.0, 2.0]);
        let b = DVector::from_vec(vec![3.0, 1.0]);
        let x = solve(&h, &b, &mut vec![true, true]).unwrap();
        assert!((x[0] - 1.5).abs() < 1e-12 && x[1] == 0.0, "{x}");
    }

    #[test]
    fn the_conditions_of_kuhn_and_tucker_hold_from_any_start() {
        let mut seed = 1_u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.4
        };
        for n in [1, 5, 30] {
            let a = DMatrix::from_fn(2 * n, n, |_, _| random());
            let y = DVector::from_fn(2 * n, |_, _| random());
            let (h, b) = (a.tr_mul(&a), a.tr_mul(&y));
            let cold = solve(&h, &b, &mut vec![]).unwrap();
            let warm = solve(&h, &b, &mut vec![true; n]).unwrap();
            assert!((&cold - &warm).amax() < 1e-9 * cold.amax().max(1.0));
            let gradient = &b - &h * &cold;
            for i in 0..n {
                assert!(cold[i] >= 0.0 && gradient[i] < 1e-9 && (cold[i] * gradient[i]).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn singular_matrices_have_no_solution() {
        assert!(solve(&DMatrix::zeros(1, 1), &DVector::from_vec(vec![1.0]), &mut vec![]).is_none());
    }
}
