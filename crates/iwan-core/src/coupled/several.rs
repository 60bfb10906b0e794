//! Several joints in one step: Newton's method on the forces N.
//!
//! With n = ΔN and s(n) = s + Δs* - c n, the equation of the step is n = N(s(n)) - N(s). The gradient of the convex function ½ nᵀ c n + Σ ∫
//! N ds along s(n) is c (n - ΔN(s(n))), and its Hessian is c - c D c with D = K - dF/ds. So Newton's method with a line search finds the
//! solution from any start, even for a singular c: joints that move alike need not be distinguished.

use super::definite;
use super::joints::JointsInMotion;
use super::lanes::{Lanes, groups};
use super::modes::CoupledModes;
use crate::error::{Error, check_length};
use crate::line_search::search_line;
use crate::memory::Trial;

/// Number of rounds after which the method returns an error. Loads from micro-slip to far beyond macro-slip took up to ten.
const MOST_ROUNDS: usize = 60;
/// Residual, in units of the sum of its terms, that counts as rounding: eight times the machine precision.
const ROUNDING: f64 = 8.0 * f64::EPSILON;
/// Number of rounds after which the allowed residual doubles with each further round, up to [`MOST_ROUNDING`]: what remains then is the
/// rounding of a law's own force.
const PATIENCE: usize = 20;
/// Largest residual, in units of the sum of its terms, that can pass as rounding of a law's force.
const MOST_ROUNDING: f64 = 1e-10;

/// Several joints with one kind of law and memory; trial points leave no trace in their states.
#[derive(Debug)]
pub struct SeveralJoints<'a, J, State, S> {
    laws: &'a [J],
    states: &'a mut [State],
    /// Working vectors, one entry per joint, one row after another: see [`Rows`].
    vectors: S,
    /// I - D^½ c D^½.
    matrix: S,
}

/// Number of rows in [`SeveralJoints::vectors`].
const ROWS: usize = 11;

/// The rows by name.
struct Rows<'a> {
    /// Slip and force of each joint at the start of the step; they are kept between steps.
    slip: &'a mut [f64],
    force: &'a mut [f64],
    /// The ΔN that is sought, and the slips to which it leads.
    n: &'a mut [f64],
    to: &'a mut [f64],
    residual: &'a mut [f64],
    /// D: K less the tangent of each joint at the slips `to`.
    slack: &'a mut [f64],
    direction: &'a mut [f64],
    /// ΔN at the start of a line search.
    start: &'a mut [f64],
    /// D^½.
    root: &'a mut [f64],
    work: &'a mut [f64],
    /// c times the direction.
    gradient: &'a mut [f64],
}

impl<'a> Rows<'a> {
    fn of(vectors: &'a mut [f64], joints: usize) -> Self {
        let mut rows = vectors[..ROWS * joints].chunks_exact_mut(joints);
        let mut row = || rows.next().unwrap_or_default();
        Self {
            slip: row(),
            force: row(),
            n: row(),
            to: row(),
            residual: row(),
            slack: row(),
            direction: row(),
            start: row(),
            root: row(),
            work: row(),
            gradient: row(),
        }
    }

    /// Slope with which the function falls along the direction: `gradient` · residual, where `gradient` is c times the direction.
    fn fall(&self) -> f64 {
        self.gradient.iter().zip(&*self.residual).map(|(g, r)| g * r).sum()
    }
}

impl<'a, State, J: Trial<State>, S: AsRef<[Lanes]> + AsMut<[Lanes]>> SeveralJoints<'a, J, State, S> {
    /// Several joints with their laws and states; `storage` must return room for the requested number of groups.
    ///
    /// # Errors
    /// [`Error::Length`] when there are not as many states as laws, or too little room.
    pub fn new(laws: &'a [J], states: &'a mut [State], storage: impl Fn(usize) -> S) -> Result<Self, Error> {
        check_length("states", states.len(), laws.len())?;
        let room = |values: usize| -> Result<S, Error> {
            let (needed, room) = (groups(values), storage(groups(values)));
            let found = room.as_ref().len();
            if found < needed { Err(Error::Length { name: "storage", needed, found }) } else { Ok(room) }
        };
        let j = laws.len();
        let mut joints = Self { laws, states, vectors: room(ROWS * j)?, matrix: room(j * j)? };
        let rows = Rows::of(joints.vectors.as_mut().as_flattened_mut(), j);
        for (i, (law, state)) in laws.iter().zip(&*joints.states).enumerate() {
            (rows.slip[i], rows.force[i]) = (law.displacement(state), law.joint_force(state));
        }
        Ok(joints)
    }

    /// Solves the step with the compliance `c` and moves the joints.
    fn step(&mut self, c: &[f64], stiffness: &[f64], ahead: &[f64]) -> Result<(), Error> {
        let j = self.laws.len();
        let Self { laws, states, vectors, matrix } = self;
        let (laws, states): (&[J], &mut [State]) = (laws, states);
        let matrix = &mut matrix.as_mut().as_flattened_mut()[..j * j];
        let mut rows = Rows::of(vectors.as_mut().as_flattened_mut(), j);
        let mut at = Iterate { c, stiffness, ahead, laws, states: &*states, allowed: ROUNDING };
        rows.n.fill(0.0);
        let mut settled = at.evaluate(&mut rows);
        let mut rounds = 0;
        while !settled {
            rounds += 1;
            if rounds > MOST_ROUNDS {
                let what = "the slips of the joints do not settle within a step: shorten the time step, and check the \
                    load for values that are not finite";
                return Err(Error::Unsupported { what });
            }
            if rounds > PATIENCE {
                at.allowed = (2.0 * at.allowed).min(MOST_ROUNDING);
            }
            newton_direction(c, &mut rows, matrix);
            rows.start.copy_from_slice(rows.n);
            settled = search_line(rows.fall(), |length| {
                let line = rows.start.iter().zip(&*rows.direction);
                rows.n.iter_mut().zip(line).for_each(|(n, (s, d))| *n = s + length * d);
                (!at.evaluate(&mut rows)).then(|| rows.fall())
            });
        }
        for i in 0..j {
            rows.force[i] = laws[i].advance(&mut states[i], rows.to[i]);
            rows.slip[i] = laws[i].displacement(&states[i]);
        }
        Ok(())
    }
}

/// Slip increment Δs of joint `i` for ΔN = `n`.
#[inline]
fn way(c: &[f64], ahead: &[f64], n: &[f64], i: usize) -> f64 {
    let row = &c[i * n.len()..(i + 1) * n.len()];
    ahead[i] - row.iter().zip(n).map(|(c, n)| c * n).sum::<f64>()
}

/// Newton's direction δ with (I - D c) δ = R. It is found through the symmetric matrix I - D^½ c D^½, which is positive definite: δ = R +
/// D^½ w with (I - D^½ c D^½) w = D^½ c R.
fn newton_direction(c: &[f64], rows: &mut Rows<'_>, matrix: &mut [f64]) {
    let Rows { slack, residual, direction, root, work, gradient, .. } = rows;
    let j = slack.len();
    root.iter_mut().zip(&**slack).for_each(|(root, slack)| *root = libm::sqrt(*slack));
    for (i, (row, of_matrix)) in c.chunks_exact(j).zip(matrix.chunks_exact_mut(j)).enumerate() {
        work[i] = root[i] * row.iter().zip(&**residual).map(|(c, r)| c * r).sum::<f64>();
        // A Cholesky factorisation needs the lower triangle only.
        for ((entry, c), other) in of_matrix[..=i].iter_mut().zip(row).zip(&**root) {
            *entry = -(root[i] * c * other);
        }
        of_matrix[i] += 1.0;
    }
    // The check of the modes makes the matrix definite; if rounding spoils that, the residual alone still points downhill.
    if definite::factorise(j, matrix) {
        definite::solve(j, matrix, work);
    } else {
        work.fill(0.0);
    }
    for i in 0..j {
        direction[i] = residual[i] + root[i] * work[i];
    }
    for (gradient, row) in gradient.iter_mut().zip(c.chunks_exact(j)) {
        *gradient = row.iter().zip(&**direction).map(|(c, d)| c * d).sum();
    }
}

/// The quantities from which the residual is computed.
struct Iterate<'a, J, State> {
    c: &'a [f64],
    stiffness: &'a [f64],
    ahead: &'a [f64],
    laws: &'a [J],
    states: &'a [State],
    /// Largest residual that counts as settled, in units of the sum of its terms.
    allowed: f64,
}

impl<State, J: Trial<State>> Iterate<'_, J, State> {
    /// Computes the residual ΔN(s(n)) - n and D at `n`; returns whether the residual is rounding alone.
    fn evaluate(&self, rows: &mut Rows<'_>) -> bool {
        let mut settled = true;
        for (i, (law, state)) in self.laws.iter().zip(self.states).enumerate() {
            let (way, k) = (way(self.c, self.ahead, rows.n, i), self.stiffness[i]);
            let (from, before, n) = (rows.slip[i], rows.force[i], rows.n[i]);
            rows.to[i] = from + way;
            let (force, tangent) = law.trial(state, rows.to[i]);
            rows.slack[i] = if tangent < k { k - tangent } else { 0.0 };
            rows.residual[i] = ((force - before) - k * way) - n;
            let terms = force.abs() + before.abs() + k * (way.abs() + from.abs()) + n.abs();
            settled &= rows.residual[i].abs() <= self.allowed * terms;
        }
        settled
    }
}

impl<State, J: Trial<State>, S: AsRef<[Lanes]> + AsMut<[Lanes]>> JointsInMotion
    for SeveralJoints<'_, J, State, S>
{
    fn count(&self) -> usize {
        self.laws.len()
    }

    fn solve<M: AsRef<[Lanes]> + AsMut<[Lanes]>>(
        &mut self,
        modes: &CoupledModes<M>,
        ahead: &[f64],
        change: &mut [f64],
    ) -> Result<(), Error> {
        if !ahead.iter().all(|way| way.is_finite()) {
            change.fill(f64::NAN);
            return Ok(());
        }
        self.step(modes.coupling(), modes.joint_stiffness(), ahead)?;
        change.copy_from_slice(Rows::of(self.vectors.as_mut().as_flattened_mut(), self.laws.len()).n);
        Ok(())
    }

    fn settle<M: AsRef<[Lanes]> + AsMut<[Lanes]>>(
        &mut self,
        modes: &CoupledModes<M>,
        ahead: &[f64],
    ) -> Result<(), Error> {
        self.step(modes.compliance(), modes.joint_stiffness(), ahead)
    }

    fn slip(&self, index: usize) -> f64 {
        self.vectors.as_ref().as_flattened()[index]
    }

    fn force(&self, index: usize) -> f64 {
        self.vectors.as_ref().as_flattened()[self.laws.len() + index]
    }

    fn stored_energy(&self, index: usize) -> f64 {
        self.laws[index].stored_energy(&self.states[index])
    }
}
