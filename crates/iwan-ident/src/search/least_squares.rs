//! Non-linear least squares between bounds, by the method of Levenberg and Marquardt (J. J. Moré, 1978, without the trust region: damping by the
//! diagonal), with finite differences and projection onto the bounds.
//!
//! The problems here have a dozen unknowns and residuals that cost microseconds. A search shall not leave the region in which a model exists, nor
//! stop where a bound and a valley meet (a valley: a direction along which the sum of squares hardly changes).

use iwan_machine::checkpoint::Digest;
use nalgebra::{DMatrix, DVector};

use super::kept::{End, Kept};
use super::triangular::rotated;

/// A least-squares problem. A function of the coordinates that fills the residuals is one; its derivatives are finite differences.
pub(crate) trait Problem {
    /// Puts the residuals at `x` into `out`; false where there are none.
    fn residuals(&mut self, x: &[f64], out: &mut [f64]) -> bool;

    /// Derivatives of the residuals with respect to the coordinates in `free`, one column each; none where finite differences are to be taken.
    fn derivatives(&mut self, _x: &[f64], _free: &[usize]) -> Option<DMatrix<f64>> {
        None
    }
}

impl<F: FnMut(&[f64], &mut [f64]) -> bool + ?Sized> Problem for F {
    fn residuals(&mut self, x: &[f64], out: &mut [f64]) -> bool {
        self(x, out)
    }
}

/// Relative reduction of the sum of squares at which a search for the minimum itself ends.
pub(crate) const TOLERANCE: f64 = 1e-8;
/// Half step of the differences, in coordinates of order one: near the cube root of rounding, where central differences are
/// best (relative errors of 1e-10); one-sided ones are good to 1e-5, enough for a direction.
const STEP: f64 = 1e-5;
/// Damping of a search's first step. Fits of fifteen records made a seventh fewer ring-downs with 1e-5; but long first steps lead into wrong valleys where a record has no noise (23 of
/// `softening`).
const FIRST_DAMPING: f64 = 1e-3;
/// Damping at which no step is left: a step is then 1e-12 of the gradient's. A search that finds no descent up to this damping has ended.
const MOST_DAMPING: f64 = 1e12;
/// Damping that holds back no step that matters: valleys are up to a million times longer than wide, which is 1e-12 in squares. A search ends only
/// after a step with no more damping than this.
const LITTLE_DAMPING: f64 = 1e-9;
/// A search that began with a neighbour's derivatives ends without new ones where these foretell less than this part of the reduction at which a
/// search ends: a third of what the search may leave anyway. A judgement.
const FORETOLD: f64 = 0.3;
/// Factor on the damping after a step that brought nothing: the next step is up to thirty times shorter.
const GROWTH: f64 = 30.0;
/// The same for coupled fits and joints of structures, whose sum of squares has a crease wherever a slider begins to slip: a step that a crease holds back is not helped by a
/// little damping. Walks of the paper's beam took a quarter less time with a factor of 1000 than with 30; fits of single modes in noise take a quarter to a fifth more with 300.
pub(crate) const LARGE_GROWTH: f64 = 300.0;
/// Most steps in a row that update the derivatives (Broyden) before these are made anew: an update tells them along one direction only. Fits of fifteen records made a seventh fewer ring-downs
/// with 10 than without an end; with 5 they made a quarter more, and between 8 and 20 the difference is a few per cent.
const MOST_UPDATES: usize = 10;
/// Longest step of a coordinate in one iteration: a factor of e for logarithms, beyond which a linearisation says nothing. Longer steps are cut to
/// it.
const LONGEST: f64 = 1.0;

/// Where a search ends sooner: from a neighbouring knee a few steps are enough to see that no better search brings a point inside a limit.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sooner {
    /// The sum of squares above which it does.
    pub(crate) above: f64,
    /// Most iterations, and the relative reduction of the sum of squares at which the search ends.
    pub(crate) iterations: usize,
    pub(crate) tolerance: f64,
}

/// What a search varies, and when it ends.
#[derive(Debug, Clone)]
pub(crate) struct Search {
    /// Number of residuals.
    pub(crate) count: usize,
    /// Coordinates that are sought; the others keep their values.
    pub(crate) free: Vec<usize>,
    /// Lower and upper bound of each coordinate.
    pub(crate) bounds: Vec<(f64, f64)>,
    /// Most iterations; a search that spends them has not converged.
    pub(crate) iterations: usize,
    /// Relative reduction of the sum of squares at which the search ends.
    pub(crate) tolerance: f64,
    /// Where it ends sooner; none: nowhere.
    pub(crate) sooner: Option<Sooner>,
    /// Whether derivatives are central and made anew at each step whatever the tolerance: where a valley is narrow and bent, searches with other
    /// derivatives end above its floor.
    pub(crate) central: bool,
    /// Factor on the damping after a step that brought nothing: [`GROWTH`] or [`LARGE_GROWTH`].
    pub(crate) growth: f64,
    /// Sum of squares that the residuals' own errors make: reductions are taken relative to this at least.
    pub(crate) floor: f64,
    /// Where the end of the search is kept, for a later process that searches the same; none: it is not kept.
    pub(crate) kept: Option<Kept>,
}

/// Where a search ended.
#[derive(Debug, Clone)]
pub(crate) struct Minimum {
    pub(crate) x: Vec<f64>,
    /// Sum of squares.
    pub(crate) cost: f64,
    /// Whether the search ended by itself and not by the number of iterations.
    pub(crate) converged: bool,
}

impl Search {
    /// A search over the coordinates in `free` with at most this many iterations, until one of them reduces the sum of squares by less than the relative `tolerance`. Residuals are
    /// taken as exact, derivatives are one-sided, and the end is not kept.
    pub(crate) const fn new(
        count: usize,
        free: Vec<usize>,
        bounds: Vec<(f64, f64)>,
        (iterations, tolerance): (usize, f64),
    ) -> Self {
        let (central, growth, floor) = (false, GROWTH, 0.0);
        Self { count, free, bounds, iterations, tolerance, sooner: None, central, growth, floor, kept: None }
    }

    /// The least sum of squares from `start`; none when there are no residuals at the start, or fewer of them than unknowns.
    pub(crate) fn run<P: Problem + ?Sized>(&self, residuals: &mut P, start: &[f64]) -> Option<Minimum> {
        let (r, cost) = self.begin(residuals, start)?;
        let Some(kept) = &self.kept else { return Some(self.go_on(residuals, start, (r, cost), &mut None)) };
        let key = self.key(start, &r);
        if let Some(End { x, cost, converged }) = kept.end(key) {
            return Some(Minimum { x, cost, converged });
        }
        let end = self.go_on(residuals, start, (r, cost), &mut None);
        kept.keep(key, (&end.x, end.cost, end.converged));
        Some(end)
    }

    /// A number for all that a search depends on: its settings, where it begins, and all residuals there. Two problems that differ in a record, a
    /// weight or a held parameter differ in these residuals.
    fn key(&self, start: &[f64], residuals: &[f64]) -> u128 {
        let bounds: Vec<f64> = self.bounds.iter().flat_map(|b| [b.0, b.1]).collect();
        let free = self.free.iter().fold(Digest::default(), |digest, j| digest.count(*j));
        let effort = free.count(self.iterations).count(usize::from(self.central)).numbers(&[
            self.tolerance,
            self.growth,
            self.floor,
        ]);
        let effort = self.sooner.iter().fold(effort, |digest, sooner| {
            digest.count(sooner.iterations).numbers(&[sooner.above, sooner.tolerance])
        });
        effort.numbers(&bounds).numbers(start).numbers(residuals).value()
    }

    /// Residuals at the start, and the sum of their squares.
    fn begin<P: Problem + ?Sized>(&self, residuals: &mut P, start: &[f64]) -> Option<(Vec<f64>, f64)> {
        let mut r = vec![0.0; self.count];
        let cost = (self.count >= self.free.len()).then(|| evaluate(residuals, start, &mut r))??;
        Some((r, cost))
    }

    /// One of many searches along a way. It begins with the derivatives `known` from the last search, which serve as long as steps bring what they
    /// foretell, and leaves its own derivatives there for the next one.
    pub(crate) fn run_along<P: Problem + ?Sized>(
        &self,
        residuals: &mut P,
        start: &[f64],
        known: &mut Option<DMatrix<f64>>,
    ) -> Option<Minimum> {
        let first = self.begin(residuals, start)?;
        Some(self.go_on(residuals, start, first, known))
    }

    /// Searches from `start`, where residuals `r` and their sum of squares are known.
    fn go_on<P: Problem + ?Sized>(
        &self,
        residuals: &mut P,
        start: &[f64],
        (mut r, mut cost): (Vec<f64>, f64),
        known: &mut Option<DMatrix<f64>>,
    ) -> Minimum {
        let (mut x, mut trial) = (start.to_vec(), vec![0.0; self.count]);
        let near = known.take().filter(|j| j.shape() == (self.count, self.free.len()));
        let along = near.is_some();
        let (mut damping, mut fresh, mut before) = (FIRST_DAMPING, !along, false);
        let mut updates = 0;
        let Some(mut jacobian) = near.or_else(|| self.jacobian(residuals, &x, &r)) else {
            return Minimum { x, cost, converged: false };
        };
        for iteration in 0..self.iterations {
            let sooner = self.sooner.filter(|sooner| cost > sooner.above);
            if sooner.is_some_and(|sooner| iteration >= sooner.iterations) {
                break;
            }
            let tolerance = sooner.map_or(self.tolerance, |sooner| sooner.tolerance);
            // Orthogonal factors in place of normal equations: valleys here are a million times longer than wide.
            let (matrix, turned) = rotated(&jacobian, &DVector::from_column_slice(&r));
            let most = if fresh { MOST_DAMPING } else { damping * 100.0 };
            let (mut part, mut taken, mut tried) = (0.0, 0.0, false);
            while damping < most {
                let next = self.step(&x, &matrix, &turned, damping);
                // A step with more damping foretells still less. A first step that damping holds back says nothing about a step with less damping.
                // Where the minimum itself is wanted the first step is taken whatever it brings.
                let little = FORETOLD * tolerance * cost.max(self.floor);
                let is_idle = next.as_ref().is_some_and(|(_, foretold)| *foretold < little);
                if is_idle && (tried || !self.is_central()) {
                    taken = if tried { 0.0 } else { damping };
                    break;
                }
                let next = next.map(|(next, _)| next);
                tried = true;
                let lower = next.as_ref().and_then(|next| evaluate(residuals, next, &mut trial));
                if let (Some(next), Some(lower)) = (next, lower.filter(|c| *c < cost)) {
                    part = (cost - lower) / cost.max(self.floor);
                    self.update(&mut jacobian, &x, &next, &r, &trial);
                    (x, cost) = (next, lower);
                    std::mem::swap(&mut r, &mut trial);
                    taken = damping;
                    damping = (damping * 0.1).max(1e-15);
                    break;
                }
                damping *= self.growth;
            }
            let slow = part < tolerance;
            // Where neither this step nor the next one brings anything by a neighbour's derivatives, these need not be made anew.
            let little = FORETOLD * tolerance * cost.max(self.floor);
            if along && slow && !fresh && Self::ahead(&jacobian, &matrix, &r) < little {
                *known = Some(jacobian);
                return Minimum { x, cost, converged: true };
            }
            // A step that brings little may be held back by its damping, or bent by a crease: after two such steps the search ends.
            let end = slow && fresh && (taken <= LITTLE_DAMPING || before);
            before = slow && fresh;
            if end {
                *known = Some(jacobian);
                return Minimum { x, cost, converged: true };
            }
            updates = if fresh { 0 } else { updates + 1 };
            fresh = slow || updates >= MOST_UPDATES || self.is_central();
            if fresh {
                damping = damping.min(if slow { LITTLE_DAMPING } else { 1.0 });
                let Some(anew) = self.jacobian(residuals, &x, &r) else { break };
                jacobian = anew;
            }
        }
        *known = Some(jacobian);
        Minimum { x, cost, converged: false }
    }

    /// Whether derivatives are central and made anew at each step: where the search wants the minimum itself, or asks for them. Otherwise derivatives
    /// are one-sided and updated by the steps taken.
    pub(crate) fn is_central(&self) -> bool {
        self.central || self.tolerance < 1e-6
    }

    /// By how much the next step should reduce the sum of squares of `r`, by the derivatives and a triangular factor that is nearly theirs.
    fn ahead(jacobian: &DMatrix<f64>, matrix: &DMatrix<f64>, r: &[f64]) -> f64 {
        let gradient = jacobian.tr_mul(&DVector::from_column_slice(r));
        matrix.tr_solve_upper_triangular(&gradient).map_or(f64::INFINITY, |step| step.norm_squared())
    }

    /// Broyden's update (Math. Comp. 19:577, 1965): the derivatives along the step taken become those that were seen.
    fn update(&self, jacobian: &mut DMatrix<f64>, from: &[f64], to: &[f64], before: &[f64], after: &[f64]) {
        let step = DVector::from_iterator(self.free.len(), self.free.iter().map(|&j| to[j] - from[j]));
        let square = step.norm_squared();
        if square > 0.0 {
            let seen = DVector::from_iterator(self.count, after.iter().zip(before).map(|(a, b)| a - b));
            let surprise = seen - &*jacobian * &step;
            jacobian.ger(1.0 / square, &surprise, &step, 1.0);
        }
    }

    /// The two values of a coordinate between which a difference is taken, both inside the bounds where the coordinate is.
    pub(crate) fn apart(at: f64, (low, high): (f64, f64), central: bool) -> [f64; 2] {
        match at + STEP {
            to if to > high => [at, at - STEP],
            to if central => [(at - STEP).max(low), to],
            to => [at, to],
        }
    }

    /// Derivatives of the residuals, which are `r` at `x`, with respect to the free coordinates.
    pub(crate) fn jacobian<P: Problem + ?Sized>(
        &self,
        residuals: &mut P,
        x: &[f64],
        r: &[f64],
    ) -> Option<DMatrix<f64>> {
        if let Some(exact) = residuals.derivatives(x, &self.free) {
            return Some(exact);
        }
        let (mut above, mut below) = (vec![0.0; self.count], r.to_vec());
        let mut jacobian = DMatrix::zeros(self.count, self.free.len());
        for (column, &j) in self.free.iter().enumerate() {
            let mut moved = x.to_vec();
            let [from, to] = Self::apart(x[j], self.bounds[j], self.is_central());
            if from != x[j] {
                moved[j] = from;
                evaluate(residuals, &moved, &mut below)?;
            }
            moved[j] = to;
            evaluate(residuals, &moved, &mut above)?;
            let slope = |(a, b): (&f64, &f64)| (a - b) / (to - from);
            jacobian
                .column_mut(column)
                .iter_mut()
                .zip(above.iter().zip(&below).map(slope))
                .for_each(|(j, s)| *j = s);
            below.copy_from_slice(r);
        }
        Some(jacobian)
    }

    /// Where the damped step from `x` leads, for the triangular factor and the turned residuals, and by how much the step would reduce the sum of
    /// squares if residuals were linear and the step were not cut. Coordinates at a bound that the step would cross stay.
    fn step(
        &self,
        x: &[f64],
        matrix: &DMatrix<f64>,
        turned: &DVector<f64>,
        damping: f64,
    ) -> Option<(Vec<f64>, f64)> {
        let mut moving: Vec<usize> = (0..self.free.len()).collect();
        loop {
            let matrix = matrix.select_columns(&moving);
            let step = damped(&matrix, turned, damping)?;
            let leaves = |&(k, &i): &(usize, &usize)| {
                let (low, high) = self.bounds[self.free[i]];
                let at = x[self.free[i]];
                (at <= low && step[k] > 0.0) || (at >= high && step[k] < 0.0)
            };
            let stays = moving.iter().enumerate().find(leaves).map(|(k, _)| k);
            let Some(k) = stays else {
                let mut next = x.to_vec();
                for (k, &i) in moving.iter().enumerate() {
                    let j = self.free[i];
                    next[j] =
                        (x[j] - step[k].clamp(-LONGEST, LONGEST)).clamp(self.bounds[j].0, self.bounds[j].1);
                }
                let foretold = turned.norm_squared() - (turned - matrix * step).norm_squared();
                return Some((next, foretold));
            };
            moving.remove(k);
            if moving.is_empty() {
                return None;
            }
        }
    }
}

/// The step s with the least |A s - r|² + damping·|D s|², where D holds the column norms of A.
fn damped(matrix: &DMatrix<f64>, turned: &DVector<f64>, damping: f64) -> Option<DVector<f64>> {
    let (rows, columns) = matrix.shape();
    let mut stacked = DMatrix::zeros(rows + columns, columns);
    stacked.view_mut((0, 0), (rows, columns)).copy_from(matrix);
    let norms: Vec<f64> = matrix.column_iter().map(|c| c.norm()).collect();
    // A coordinate without any effect stays where it is.
    let floor = 1e-7 * norms.iter().fold(f64::MIN_POSITIVE, |m, n| m.max(*n));
    for (i, norm) in norms.iter().enumerate() {
        stacked[(rows + i, i)] = damping.sqrt() * norm.max(floor);
    }
    let mut right = DVector::zeros(rows + columns);
    right.rows_mut(0, rows).copy_from(turned);
    let (factor, right) = rotated(&stacked, &right);
    factor.solve_upper_triangular(&right)
}

/// How the coordinates of all other columns follow a change of the last one by 1, so that the residuals stay as small as they can.
pub(crate) fn following(jacobian: &DMatrix<f64>) -> Option<Vec<f64>> {
    let last = jacobian.ncols().checked_sub(1)?;
    let step = damped(&jacobian.columns(0, last).into_owned(), &-jacobian.column(last), LITTLE_DAMPING)?;
    Some(step.as_slice().to_vec())
}

fn evaluate<P: Problem + ?Sized>(residuals: &mut P, x: &[f64], r: &mut [f64]) -> Option<f64> {
    let found = x.iter().all(|x| x.is_finite()) && residuals.residuals(x, r);
    let cost: f64 = r.iter().map(|r| r * r).sum();
    (found && cost.is_finite()).then_some(cost)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn search(count: usize, free: &[usize], bounds: &[(f64, f64)]) -> Search {
        Search::new(count, free.to_vec(), bounds.to_vec(), (200, TOLERANCE))
    }

    const NONE: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

    fn rosenbrock(x: &[f64], r: &mut [f64]) -> bool {
        (r[0], r[1]) = (10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0]);
        true
    }

    #[test]
    fn rosenbrock_valley() {
        let found = search(2, &[0, 1], &[NONE; 2]).run(&mut rosenbrock, &[-1.2, 1.0]).unwrap();
        assert!((found.x[0] - 1.0).abs() < 1e-6 && found.converged);
        let held = search(2, &[1], &[NONE; 2]).run(&mut rosenbrock, &[0.5, 0.0]).unwrap();
        assert!((held.x[1] - 0.25).abs() < 1e-9 && held.x[0] == 0.5);
    }

    #[test]
    fn a_bound_in_the_valley_ends_the_search_on_it() {
        // With x0 = 0.5 the least sum of squares is at x1 = 0.25.
        let bounds = [(-2.0, 0.5), NONE];
        let found = search(2, &[0, 1], &bounds).run(&mut rosenbrock, &[-1.2, 1.0]).unwrap();
        assert!(found.x[0] == 0.5 && (found.x[1] - 0.25).abs() < 1e-6, "{:?}", found.x);
    }

    #[test]
    fn a_first_step_held_back_by_its_damping_is_not_the_end() {
        // Along x0 = x1 the sum of squares is ten decades flatter than across.
        let mut valley = |x: &[f64], r: &mut [f64]| {
            (r[0], r[1]) = (1e5 * (x[0] - x[1]), x[0] + x[1] - 2.0);
            true
        };
        let search = Search { tolerance: 1e-5, ..search(2, &[0, 1], &[NONE; 2]) };
        let found = search.run(&mut valley, &[0.0, 0.0]).unwrap();
        assert!((found.x[0] - 1.0).abs() < 1e-2 && found.converged, "{:?}", found.x);
    }

    #[test]
    fn a_search_ends_sooner_where_the_sum_of_squares_stays_high() {
        let start = [-1.2, 1.0];
        let ending = |above: f64| {
            let sooner = Some(Sooner { above, iterations: 3, tolerance: 0.03 });
            Search { sooner, ..search(2, &[0, 1], &[NONE; 2]) }.run(&mut rosenbrock, &start).unwrap()
        };
        let three = Search { iterations: 3, ..search(2, &[0, 1], &[NONE; 2]) };
        let three = three.run(&mut rosenbrock, &start).unwrap();
        assert!(three.cost > 0.1 && !three.converged);
        let high = ending(1e-9 * three.cost);
        assert!((high.x, high.cost, high.converged) == (three.x, three.cost, false));
        let low = ending(2.0 * three.cost);
        assert!((low.x[0] - 1.0).abs() < 1e-6 && low.converged);
    }

    #[test]
    fn others_follow_along_the_valley() {
        // r = (x0 - 3 x1, 0): x0 goes three times as far as x1.
        let jacobian = DMatrix::from_row_slice(2, 2, &[1.0, -3.0, 0.0, 0.0]);
        assert!((following(&jacobian).unwrap()[0] - 3.0).abs() < 1e-6);
    }

    #[test]
    fn fewer_residuals_than_unknowns_tell_no_minimum() {
        let short = search(1, &[0, 1], &[NONE; 2]);
        assert!(
            short
                .run(
                    &mut |x: &[f64], r: &mut [f64]| {
                        r[0] = x[0] - x[1];
                        true
                    },
                    &[0.0, 1.0]
                )
                .is_none()
        );
    }

    #[test]
    fn no_residuals_no_minimum() {
        assert!(search(2, &[0], &[NONE]).run(&mut |_: &[f64], _: &mut [f64]| false, &[0.0]).is_none());
    }
}
