//! Continuation of solution curves by arc length: a predictor along the tangent, Newton's method across it, and a step length that follows
//! the curve's bend.

use nalgebra::{DMatrix, DVector};

use crate::error::SimulationError;

/// A system with one equation fewer than unknowns, so that its solutions form a curve.
pub(super) trait Curve {
    /// Called before a step. It may choose anew the meaning of unknowns, such as the mode kept apart, without leaving the solution; it
    /// returns whether it did.
    ///
    /// # Errors
    /// [`SimulationError`] where an unknown is not finite.
    fn prepare(&mut self, y: &mut [f64]) -> Result<bool, SimulationError>;

    /// Scale of each unknown: the change that counts as a step of length 1.
    fn scales(&self, y: &[f64]) -> Vec<f64>;

    /// The longest step from a node (in the scaled unknowns) that does not skip a feature of the curve known to lie there.
    fn longest(&self, from: &Node) -> f64;

    /// Evaluates the equations and their derivatives.
    ///
    /// # Errors
    /// [`SimulationError`] where an unknown is not finite.
    fn evaluate(
        &mut self,
        y: &[f64],
        residual: &mut DVector<f64>,
        jacobian: &mut DMatrix<f64>,
    ) -> Result<(), SimulationError>;
}

/// A point on a curve, with the curve's direction at the point.
#[derive(Debug, Clone)]
pub(super) struct Node {
    pub(super) y: Vec<f64>,
    /// Tangent of the curve, of unit length in the scaled unknowns.
    pub(super) tangent: Vec<f64>,
}

/// Longest step in the scaled unknowns: a tenth of the motion's own size gives a curve of 25 points a decade.
const LONGEST: f64 = 0.1;
/// First step, in the scaled unknowns.
const FIRST: f64 = 0.02;
/// Shortest step, in the scaled unknowns: below it only rounding changes, and the curve ends there.
const SHORTEST: f64 = 1e-9;
/// Desired distance between predictor and curve, in the scaled unknowns; it sets the length of the next step. With it straight lines
/// between the points look smooth, and Newton's method starts well within its range of convergence.
const BEND: f64 = 3e-3;
/// Newton's method has converged when its step is shorter than this, in the scaled unknowns; the remaining error is about its square.
const CONVERGED: f64 = 1e-9;
/// Largest number of rounds of Newton's method: from so near a start it takes two to four. If they do not suffice, the step is shortened.
const ROUNDS: usize = 8;

/// Follows a curve.
pub(super) struct Follower<'a, P> {
    pub(super) curve: &'a mut P,
    residual: DVector<f64>,
    jacobian: DMatrix<f64>,
    step: f64,
}

/// The additional equation of Newton's method.
enum Across<'a> {
    /// The unknown of this index keeps its value.
    Held(usize),
    /// The distance from a point along a direction stays zero. The direction is given times the inverse squares of the scales.
    Along(&'a [f64], &'a [f64]),
}

impl<'a, P: Curve> Follower<'a, P> {
    pub(super) fn new(curve: &'a mut P, unknowns: usize) -> Self {
        let residual = DVector::zeros(unknowns - 1);
        Self { curve, residual, jacobian: DMatrix::zeros(unknowns - 1, unknowns), step: FIRST }
    }

    /// Newton's method; returns whether it has converged within [`ROUNDS`].
    fn correct(
        &mut self,
        y: &mut [f64],
        scales: &[f64],
        across: &Across<'_>,
    ) -> Result<bool, SimulationError> {
        let count = y.len();
        let mut last = f64::INFINITY;
        for _ in 0..ROUNDS {
            self.curve.evaluate(y, &mut self.residual, &mut self.jacobian)?;
            let mut matrix = DMatrix::zeros(count, count);
            matrix.rows_mut(0, count - 1).copy_from(&self.jacobian);
            let mut right = DVector::zeros(count);
            right.rows_mut(0, count - 1).copy_from(&(-&self.residual));
            match across {
                Across::Held(index) => matrix[(count - 1, *index)] = 1.0 / scales[*index],
                Across::Along(direction, from) => {
                    for (i, d) in direction.iter().enumerate() {
                        matrix[(count - 1, i)] = *d;
                        right[count - 1] -= d * (y[i] - from[i]);
                    }
                }
            }
            let Some(change) = solved(matrix, &right, scales) else { return Ok(false) };
            let size = change.iter().zip(scales).map(|(c, s)| (c / s).powi(2)).sum::<f64>().sqrt();
            if !size.is_finite() || size > 4.0 * last.max(1.0) {
                return Ok(false);
            }
            for (y, c) in y.iter_mut().zip(change.iter()) {
                *y += c;
            }
            if size < CONVERGED {
                return Ok(true);
            }
            last = size;
        }
        Ok(false)
    }

    /// A point on the curve at which the unknown number `held` keeps its value; none if Newton's method does not find one.
    pub(super) fn at_held(&mut self, y: &[f64], held: usize) -> Result<Option<Vec<f64>>, SimulationError> {
        let mut y = y.to_vec();
        self.curve.prepare(&mut y)?;
        let scales = self.curve.scales(&y);
        let found = self.correct(&mut y, &scales, &Across::Held(held))?;
        Ok(found.then_some(y))
    }

    /// The first node, with the tangent in the direction in which the unknown `leading` grows (`sign` = 1) or falls (`sign` = -1).
    pub(super) fn first(
        &mut self,
        y: Vec<f64>,
        leading: usize,
        sign: f64,
    ) -> Result<Option<Node>, SimulationError> {
        let mut guess = vec![0.0; y.len()];
        let scales = self.curve.scales(&y);
        guess[leading] = sign * scales[leading];
        self.node(y, &guess)
    }

    /// The node of a point on the curve; its tangent continues the direction `before`.
    fn node(&mut self, y: Vec<f64>, before: &[f64]) -> Result<Option<Node>, SimulationError> {
        let count = y.len();
        let scales = self.curve.scales(&y);
        self.curve.evaluate(&y, &mut self.residual, &mut self.jacobian)?;
        let mut matrix = DMatrix::zeros(count, count);
        matrix.rows_mut(0, count - 1).copy_from(&self.jacobian);
        for (i, b) in before.iter().enumerate() {
            matrix[(count - 1, i)] = b / (scales[i] * scales[i]);
        }
        let mut right = DVector::zeros(count);
        right[count - 1] = 1.0;
        let Some(tangent) = solved(matrix, &right, &scales) else { return Ok(None) };
        let size = tangent.iter().zip(&scales).map(|(t, s)| (t / s).powi(2)).sum::<f64>().sqrt();
        let tangent: Vec<f64> = tangent.iter().map(|t| t / size).collect();
        Ok(tangent.iter().all(|t| t.is_finite()).then_some(Node { y, tangent }))
    }

    /// The node at the distance `step` from `from` along its tangent, and the distance between predictor and curve there; none if Newton's
    /// method does not converge.
    pub(super) fn at_distance(
        &mut self,
        from: &Node,
        step: f64,
    ) -> Result<Option<(Node, f64)>, SimulationError> {
        let scales = self.curve.scales(&from.y);
        let guess: Vec<f64> = from.y.iter().zip(&from.tangent).map(|(y, t)| y + step * t).collect();
        let direction: Vec<f64> = from.tangent.iter().zip(&scales).map(|(t, s)| t / (s * s)).collect();
        let mut y = guess.clone();
        if !self.correct(&mut y, &scales, &Across::Along(&direction, &guess))? {
            return Ok(None);
        }
        let gap = |(i, s): (usize, &f64)| ((y[i] - guess[i]) / s).powi(2);
        let bend = scales.iter().enumerate().map(gap).sum::<f64>().sqrt();
        Ok(self.node(y, &from.tangent)?.map(|node| (node, bend)))
    }

    /// The next node and the step that led to it; none if the curve cannot be followed any further.
    pub(super) fn next(&mut self, from: &mut Node) -> Result<Option<(Node, f64)>, SimulationError> {
        if self.curve.prepare(&mut from.y)?
            && let Some(turned) = self.node(from.y.clone(), &from.tangent)?
        {
            *from = turned;
        }
        self.step = self.step.min(self.curve.longest(from));
        while self.step > SHORTEST {
            let step = self.step;
            let found = self.at_distance(from, step)?;
            if let Some((node, bend)) = found {
                // The distance between predictor and curve grows with the square of the step.
                let wanted = step * (BEND / bend.max(1e-12)).sqrt();
                if bend < 4.0 * BEND || step < 1e-4 {
                    self.step = wanted.clamp(0.3 * step, 2.0 * step).min(LONGEST);
                    return Ok(Some((node, step)));
                }
            }
            self.step = 0.4 * step;
        }
        Ok(None)
    }
}

/// Solves with all unknowns divided by their scales, so that pivots are chosen among numbers of equal size.
fn solved(mut matrix: DMatrix<f64>, right: &DVector<f64>, scales: &[f64]) -> Option<DVector<f64>> {
    let mut right = right.clone();
    for (mut column, scale) in matrix.column_iter_mut().zip(scales) {
        column *= *scale;
    }
    for (i, mut row) in matrix.row_iter_mut().enumerate() {
        let most = row.amax();
        if most > 0.0 {
            row /= most;
            right[i] /= most;
        }
    }
    let mut solution = matrix.lu().solve(&right)?;
    for (entry, scale) in solution.iter_mut().zip(scales) {
        *entry *= scale;
    }
    solution.iter().all(|x| x.is_finite()).then_some(solution)
}
