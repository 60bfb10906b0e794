//! The small system for the slips of a structure in one implicit time step.
//!
//! S Δs + F(s + Δs) - F(s) = load, with S symmetric and positive definite: a Schur complement of the effective matrix. The left side is the
//! gradient of a strictly convex function. Therefore Newton's method with a line search along the gradient finds the unique solution from
//! any start, on piecewise linear joints as well as on smooth ones. Trial points leave no trace in the joints' memory, and as long as no
//! joint changes its tangent one round is exact.

use super::joint_states::Joints;
use crate::algebra::{Group, LANES, dot, search_line};
use crate::error::Error;
use crate::matrices::inverse_of;

/// Number of rounds after which the method returns an error. One or two are usual, and six were the most in blows of 10 to 1e7 lbf on the
/// paper's beam.
const MOST_ROUNDS: usize = 60;
/// Number of rank-one updates of the inverse after which it is computed anew, so that rounding does not accumulate. It is a precaution:
/// without it the energy balance of 20,000 steps is as good. If the inverse were computed anew at each update, a run would take up to twice
/// the time.
const MOST_UPDATES: usize = 64;
/// Residual, in units of the sum of its terms, that counts as rounding: eight times the machine precision. With a factor of two the
/// continuum takes a third more rounds, and with one some steps wait for [`PATIENCE`]; a hundred times as much shows in the energy balance
/// (1e-13 in place of 1e-14).
const ROUNDING: f64 = 8.0 * f64::EPSILON;
/// Number of rounds, which only badly conditioned systems need, after which the allowed residual doubles with each further round: in such
/// systems rounding leaves more.
const PATIENCE: usize = 25;
/// Largest residual, in units of the sum of its terms, that may count as rounding; with a larger one the step ends in an error.
const MOST_ROUNDING: f64 = 1e-10;

/// A symmetric matrix stored by columns, each in groups of lanes; the last group is filled up with zeros.
pub(crate) struct Square {
    groups: usize,
    columns: Vec<Group>,
}

impl Square {
    /// The matrix from its entries row by row.
    pub(crate) fn new(order: usize, entries: &[f64]) -> Self {
        let groups = order.div_ceil(LANES);
        let group = |j: usize, g: usize| -> Group {
            std::array::from_fn(
                |l| if g * LANES + l < order { entries[j * order + g * LANES + l] } else { 0.0 },
            )
        };
        Self { groups, columns: (0..order * groups).map(|k| group(k / groups, k % groups)).collect() }
    }

    /// y = A x, where x has one entry per column.
    #[inline]
    pub(crate) fn multiply(&self, x: &[Group], y: &mut [Group]) {
        let x = x.as_flattened();
        for (g, y) in y.iter_mut().enumerate() {
            let mut sums = [0.0; LANES];
            for (column, value) in self.columns.chunks_exact(self.groups).zip(x) {
                for l in 0..LANES {
                    sums[l] += value * column[g][l];
                }
            }
            *y = sums;
        }
    }

    fn entry(&self, i: usize, j: usize) -> f64 {
        self.columns[j * self.groups + i / LANES][i % LANES]
    }
}

/// S, the tangents K last found, and (S + K)⁻¹.
pub(crate) struct SlipSolver {
    count: usize,
    stiffness: Square,
    /// Square roots of the diagonal of S; |S_ij| is at most the product of two of them.
    roots: Vec<Group>,
    tangents: Vec<Group>,
    inverse: Square,
    updates: usize,
    /// Largest residual that counts as settled, in units of the sum of its terms.
    allowed: f64,
    /// Largest force of each joint so far; the rounding of its force is measured against it.
    scale: Vec<Group>,
    /// Slips of all joints and their forces.
    slips: Vec<Group>,
    forces: Vec<Group>,
    /// Δs of the last step.
    increments: Vec<Group>,
    trial_tangents: Vec<Group>,
    residual: Vec<Group>,
    direction: Vec<Group>,
    start: Vec<Group>,
}

impl SlipSolver {
    /// The solver for the matrix S, given row by row, and joints in their virgin state.
    pub(crate) fn new(stiffness: &[f64], joints: &mut Joints<'_>) -> Result<Self, Error> {
        let count = joints.len();
        let zero = || vec![[0.0; LANES]; count.div_ceil(LANES)];
        let (mut tangents, mut roots) = (zero(), zero());
        for i in 0..count {
            tangents[i / LANES][i % LANES] = joints.trial(i, 0.0).1;
            roots[i / LANES][i % LANES] = stiffness[i * count + i].sqrt();
        }
        let mut solver = Self {
            count,
            stiffness: Square::new(count, stiffness),
            roots,
            tangents,
            inverse: Square::new(count, stiffness),
            updates: 0,
            allowed: ROUNDING,
            scale: zero(),
            slips: zero(),
            forces: zero(),
            increments: zero(),
            trial_tangents: zero(),
            residual: zero(),
            direction: zero(),
            start: zero(),
        };
        solver.invert()?;
        Ok(solver)
    }

    /// Passes every number that one step leaves to the next to `see`.
    pub(crate) fn each_number(&mut self, see: &mut dyn FnMut(&mut f64)) {
        let lists = [
            &mut self.tangents,
            &mut self.inverse.columns,
            &mut self.scale,
            &mut self.slips,
            &mut self.forces,
            &mut self.increments,
        ];
        lists.into_iter().flat_map(|list| list.as_flattened_mut()).for_each(&mut *see);
        let mut updates = self.updates as f64;
        see(&mut updates);
        self.updates = updates as usize;
    }

    /// Slips of all joints, followed by zeros that fill the last group.
    pub(crate) fn slips(&self) -> &[f64] {
        self.slips.as_flattened()
    }

    /// Forces of all joints.
    pub(crate) fn forces(&self) -> &[f64] {
        self.forces.as_flattened()
    }

    /// Δs of the last step.
    pub(crate) fn increments(&self) -> &[f64] {
        self.increments.as_flattened()
    }

    /// Computes (S + K)⁻¹ anew.
    fn invert(&mut self) -> Result<(), Error> {
        self.updates = 0;
        let tangents = self.tangents.as_flattened();
        let entry = |i: usize, j: usize| self.stiffness.entry(i, j) + if i == j { tangents[i] } else { 0.0 };
        self.inverse = Square::new(self.count, &inverse_of(self.count, entry)?);
        Ok(())
    }

    /// Adopts the tangents found at the trial point, by rank-one updates of the inverse.
    #[inline]
    fn follow_tangents(&mut self) -> Result<(), Error> {
        let groups = self.inverse.groups;
        for i in 0..self.count {
            let (g, l) = (i / LANES, i % LANES);
            let change = self.trial_tangents[g][l] - self.tangents[g][l];
            if change == 0.0 {
                continue;
            }
            self.tangents[g][l] = self.trial_tangents[g][l];
            self.updates += 1;
            self.direction.copy_from_slice(&self.inverse.columns[i * groups..(i + 1) * groups]);
            let factor = change / (1.0 + change * self.direction[g][l]);
            for (j, column) in self.inverse.columns.chunks_exact_mut(groups).enumerate() {
                let scaled = factor * self.direction[j / LANES][j % LANES];
                for (w, d) in column.iter_mut().zip(&self.direction) {
                    (0..LANES).for_each(|l| w[l] -= scaled * d[l]);
                }
            }
        }
        if self.updates > MOST_UPDATES { self.invert() } else { Ok(()) }
    }

    /// Computes the residual at the present increments; returns whether it is rounding alone.
    #[inline]
    fn evaluate(&mut self, joints: &mut Joints<'_>, load: &[Group]) -> bool {
        self.stiffness.multiply(&self.increments, &mut self.residual);
        let mut size = 0.0;
        for (roots, increments) in self.roots.iter().zip(&self.increments) {
            (0..LANES).for_each(|l| size += roots[l] * increments[l].abs());
        }
        let mut settled = true;
        for i in 0..self.count {
            let (g, l) = (i / LANES, i % LANES);
            let at = self.slips[g][l] + self.increments[g][l];
            let (force, tangent) = joints.trial(i, at);
            self.trial_tangents[g][l] = tangent;
            let residual = (load[g][l] - self.residual[g][l]) - (force - self.forces[g][l]);
            self.residual[g][l] = residual;
            let of_forces = force.abs() + self.scale[g][l] + tangent * at.abs();
            let terms = load[g][l].abs() + self.roots[g][l] * size + of_forces;
            settled &= residual.abs() <= self.allowed * terms;
        }
        settled
    }

    /// Solves one step and moves the joints; the increments remain in `increments`. Entries of `load` after the last joint must be zero.
    ///
    /// # Errors
    /// [`Error::Analysis`] when the iteration does not converge, as with a load that is not finite.
    #[inline]
    pub(crate) fn step(&mut self, joints: &mut Joints<'_>, load: &[Group]) -> Result<(), Error> {
        self.inverse.multiply(load, &mut self.increments);
        let mut rounds = 0;
        self.allowed = ROUNDING;
        while !self.evaluate(joints, load) {
            rounds += 1;
            if rounds > MOST_ROUNDS {
                return Err(self.unsettled());
            }
            if rounds > PATIENCE {
                self.allowed = (2.0 * self.allowed).min(MOST_ROUNDING);
            }
            self.follow_tangents()?;
            if self.newton_step(joints, load) {
                break;
            }
        }
        for i in 0..self.count {
            let (g, l) = (i / LANES, i % LANES);
            self.slips[g][l] += self.increments[g][l];
            let force = joints.advance(i, self.slips[g][l]);
            self.forces[g][l] = force;
            // Not `f64::max`, which takes time to treat NaN.
            self.scale[g][l] = if force.abs() > self.scale[g][l] { force.abs() } else { self.scale[g][l] };
        }
        Ok(())
    }

    /// One step of Newton's method, shortened where the gradient along it has changed sign; returns whether the result is accepted as the
    /// solution.
    fn newton_step(&mut self, joints: &mut Joints<'_>, load: &[Group]) -> bool {
        self.inverse.multiply(&self.residual, &mut self.direction);
        self.start.copy_from_slice(&self.increments);
        let slope = dot(self.direction.as_flattened(), self.residual.as_flattened());
        search_line(slope, |length| {
            for ((x, start), d) in self.increments.iter_mut().zip(&self.start).zip(&self.direction) {
                (0..LANES).for_each(|l| x[l] = start[l] + length * d[l]);
            }
            let settled = self.evaluate(joints, load);
            (!settled).then(|| dot(self.direction.as_flattened(), self.residual.as_flattened()))
        })
    }

    fn unsettled(&self) -> Error {
        let largest = |m: f64, r: &f64| if r.is_nan() { f64::NAN } else { m.max(r.abs()) };
        let worst = self.residual.as_flattened().iter().fold(0.0, largest);
        Error::Analysis {
            analysis: "transient",
            finding: format!(
                "the slips do not settle within {MOST_ROUNDS} rounds (residual force {worst:.3e})"
            ),
            remedy: "check loads and initial conditions for values that are not finite, and shorten the time step",
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use iwan_core::FourParameter;

    use super::*;
    use crate::algebra::random;
    use crate::structure::Law;
    use crate::transient::joint_states::tables;
    use iwan_core::Representation;

    /// For random systems and loads from micro-slip to far beyond macro-slip the equation holds to rounding.
    #[test]
    fn the_equation_holds_whatever_the_load() {
        let law: Law = Arc::new(FourParameter::new(2.75e5, 300.0, -0.3, 0.02).unwrap());
        let laws = [Some(&law), Some(&law), None, Some(&law), Some(&law)];
        let n = laws.len();
        for representation in [Representation::in_a_structure(50), Representation::Continuum] {
            let mut memory = tables(n, representation);
            let mut joints = Joints::new(laws.into_iter(), representation, &mut memory).unwrap();
            let a = random(n * n, 3);
            let stiffness: Vec<f64> = (0..n * n)
                .map(|k| {
                    let (i, j) = (k / n, k % n);
                    let product: f64 = (0..n).map(|l| a[i * n + l] * a[j * n + l]).sum();
                    1e3 * (product + if i == j { 0.01 } else { 0.0 })
                })
                .collect();
            let mut solver = SlipSolver::new(&stiffness, &mut joints).unwrap();
            for seed in 0..400 {
                let scale = 10.0_f64.powi((seed % 7) as i32 - 2);
                let mut load = [[0.0; LANES]];
                random(n, 1000 + seed).iter().zip(&mut load[0]).for_each(|(x, l)| *l = scale * x);
                let before = solver.forces().to_vec();
                solver.step(&mut joints, &load).unwrap();
                for i in 0..n {
                    let terms = (0..n).map(|j| stiffness[i * n + j] * solver.increments()[j]);
                    let (inertia, size): (f64, f64) =
                        terms.fold((0.0, 0.0), |(x, y), t| (x + t, y + t.abs()));
                    let error = inertia + solver.forces()[i] - before[i] - load[0][i];
                    let rounding =
                        1e-12 * (size + 600.0) + 8.0 * f64::EPSILON * 2.75e5 * solver.slips()[i].abs();
                    assert!(error.abs() < rounding, "{representation:?} {seed} {i} {error} {rounding}");
                }
            }
        }
    }
}
