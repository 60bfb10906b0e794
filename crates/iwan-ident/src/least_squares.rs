//! Non-linear least squares without bounds, by Levenberg's and Marquardt's method (J. J. Moré, 1978, without the
//! trust region: damping by the diagonal), with central differences.
//!
//! The problems here have up to a dozen unknowns in coordinates that have no bounds by construction; that is why no
//! bounded solver is needed.

use nalgebra::{DMatrix, DVector};

/// Residuals into the second argument; false where there are none.
pub(crate) type Residuals<'a> = dyn FnMut(&[f64], &mut [f64]) -> bool + 'a;

/// Relative reduction of the sum of squares at which a search ends that wants the minimum itself.
pub(crate) const TOLERANCE: f64 = 1e-10;
/// Half step of the central differences, in coordinates of order one.
const STEP: f64 = 1e-5;

/// Where a search ended.
#[derive(Debug, Clone)]
pub(crate) struct Minimum {
    pub(crate) x: Vec<f64>,
    /// Sum of squares.
    pub(crate) cost: f64,
    /// Whether it ended by itself and not by the number of iterations.
    pub(crate) converged: bool,
}

/// Searches from `start` for the least sum of squares of `count` residuals over the coordinates that are `free`, until
/// an iteration reduces it by less than the tolerance.
/// None when the start has no residuals.
pub(crate) fn minimise(
    residuals: &mut Residuals<'_>,
    count: usize,
    start: &[f64],
    free: &[usize],
    (iterations, tolerance): (usize, f64),
) -> Option<Minimum> {
    let mut x = start.to_vec();
    let (mut r, mut trial) = (vec![0.0; count], vec![0.0; count]);
    let mut cost = evaluate(residuals, &x, &mut r)?;
    let mut damping = 1e-3;
    for _ in 0..iterations {
        let (matrix, gradient) = normal(residuals, &x, &r, free)?;
        let mut reduced = None;
        while damping < 1e12 {
            let step = solve(&matrix, &gradient, damping);
            let mut next = x.clone();
            if let Some(step) = step {
                free.iter().zip(step.iter()).for_each(|(&j, s)| next[j] -= s.clamp(-2.0, 2.0));
                if let Some(lower) = evaluate(residuals, &next, &mut trial).filter(|c| *c < cost) {
                    reduced = Some((cost - lower) / cost);
                    (x, cost) = (next, lower);
                    std::mem::swap(&mut r, &mut trial);
                    damping = (damping * 0.1).max(1e-15);
                    break;
                }
            }
            damping *= 10.0;
        }
        if reduced.is_none_or(|part| part < tolerance) {
            return Some(Minimum { x, cost, converged: true });
        }
    }
    Some(Minimum { x, cost, converged: false })
}

fn evaluate(residuals: &mut Residuals<'_>, x: &[f64], r: &mut [f64]) -> Option<f64> {
    let found = x.iter().all(|x| x.is_finite()) && residuals(x, r);
    let cost: f64 = r.iter().map(|r| r * r).sum();
    (found && cost.is_finite()).then_some(cost)
}

/// Normal matrix JᵀJ and gradient Jᵀr over the free coordinates.
fn normal(
    residuals: &mut Residuals<'_>,
    x: &[f64],
    r: &[f64],
    free: &[usize],
) -> Option<(DMatrix<f64>, DVector<f64>)> {
    let (mut above, mut below) = (vec![0.0; r.len()], vec![0.0; r.len()]);
    let mut jacobian = DMatrix::zeros(r.len(), free.len());
    for (column, &j) in free.iter().enumerate() {
        let mut moved = x.to_vec();
        moved[j] = x[j] + STEP;
        evaluate(residuals, &moved, &mut above)?;
        moved[j] = x[j] - STEP;
        evaluate(residuals, &moved, &mut below)?;
        let slope = |(a, b): (&f64, &f64)| (a - b) / (2.0 * STEP);
        jacobian
            .column_mut(column)
            .iter_mut()
            .zip(above.iter().zip(&below).map(slope))
            .for_each(|(j, s)| *j = s);
    }
    let gradient = jacobian.tr_mul(&DVector::from_column_slice(r));
    Some((jacobian.tr_mul(&jacobian), gradient))
}

/// The damped step; coordinates without any effect stay where they are.
fn solve(matrix: &DMatrix<f64>, gradient: &DVector<f64>, damping: f64) -> Option<DVector<f64>> {
    let largest = matrix.diagonal().max();
    let mut damped = matrix.clone();
    for i in 0..matrix.nrows() {
        damped[(i, i)] += damping * matrix[(i, i)].max(1e-14 * largest);
    }
    damped.cholesky().map(|factor| factor.solve(gradient))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rosenbrock_valley() {
        let mut rosenbrock = |x: &[f64], r: &mut [f64]| {
            (r[0], r[1]) = (10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0]);
            true
        };
        let found = minimise(&mut rosenbrock, 2, &[-1.2, 1.0], &[0, 1], (200, TOLERANCE)).unwrap();
        assert!((found.x[0] - 1.0).abs() < 1e-6 && found.converged);
        let held = minimise(&mut rosenbrock, 2, &[0.5, 0.0], &[1], (200, TOLERANCE)).unwrap();
        assert!((held.x[1] - 0.25).abs() < 1e-9 && held.x[0] == 0.5);
    }

    #[test]
    fn no_residuals_no_minimum() {
        assert!(minimise(&mut |_, _| false, 2, &[0.0], &[0], (10, TOLERANCE)).is_none());
    }
}
