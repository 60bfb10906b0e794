//! Curves of solutions: predictor along the tangent, Newton's method across it, steps as long as the curve is straight.

use nalgebra::{DMatrix, DVector};

use crate::error::SimulationError;

/// Equations, one fewer than unknowns: their solutions are a curve.
pub(super) trait Curve {
    /// Before a step: chooses what the equations may choose anew without leaving the solution; returns whether unknowns have
    /// changed their meaning.
    ///
    /// # Errors
    /// [`SimulationError`] where an unknown is not finite.
    fn prepare(&mut self, y: &mut [f64]) -> Result<bool, SimulationError>;

    /// Sizes of the unknowns: what is a large step in each.
    fn scales(&self, y: &[f64]) -> Vec<f64>;

    /// The longest step from a node that passes over nothing which the curve is known to do there.
    fn longest(&self, from: &Node) -> f64;

    /// Equations and their derivatives.
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

/// A point on a curve with its direction there.
#[derive(Debug, Clone)]
pub(super) struct Node {
    pub(super) y: Vec<f64>,
    /// Unit length in the scaled unknowns.
    pub(super) tangent: Vec<f64>,
}

/// Longest step in the scaled unknowns: a tenth of the motion's own size makes a curve of 25 points a decade.
const LONGEST: f64 = 0.1;
/// First step.
const FIRST: f64 = 0.02;
/// Shortest step: below it, what changes is rounding.
const SHORTEST: f64 = 1e-9;
/// How far predictor and curve may be apart, in the scaled unknowns: straight lines between the points then look smooth,
/// and Newton's method starts well within its reach.
const BEND: f64 = 3e-3;
/// Newton's method has converged where it moves by less than this, in the scaled unknowns; its error is then the square.
const CONVERGED: f64 = 1e-9;
/// Most rounds of Newton's method: it takes two to four from a start so near.
const ROUNDS: usize = 8;

/// Follows a curve.
pub(super) struct Follower<'a, P> {
    pub(super) curve: &'a mut P,
    residual: DVector<f64>,
    jacobian: DMatrix<f64>,
    step: f64,
}

/// What Newton's method keeps.
enum Across<'a> {
    /// The unknown of this index.
    Held(usize),
    /// The distance along a direction (given times the inverse squares of the scales) from a point.
    Along(&'a [f64], &'a [f64]),
}

impl<'a, P: Curve> Follower<'a, P> {
    pub(super) fn new(curve: &'a mut P, unknowns: usize) -> Self {
        let residual = DVector::zeros(unknowns - 1);
        Self { curve, residual, jacobian: DMatrix::zeros(unknowns - 1, unknowns), step: FIRST }
    }

    /// Newton's method; returns whether it has converged, in few enough rounds.
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

    /// A point on the curve at which the unknown `held` keeps its value; none where Newton's method does not find it.
    pub(super) fn at_held(&mut self, y: &[f64], held: usize) -> Result<Option<Vec<f64>>, SimulationError> {
        let mut y = y.to_vec();
        self.curve.prepare(&mut y)?;
        let scales = self.curve.scales(&y);
        let found = self.correct(&mut y, &scales, &Across::Held(held))?;
        Ok(found.then_some(y))
    }

    /// The first node: the direction in which the unknown `leading` grows (or falls, with a negative `sign`).
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

    /// A point with its tangent, in the direction of `before`.
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

    /// The point at the distance `step` from a node along its tangent.
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

    /// The next node and the step that led to it; none where the curve cannot be followed.
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
                // The bend goes with the square of the step.
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

/// Solves with all unknowns in their scales, so that pivots are chosen among equals.
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
