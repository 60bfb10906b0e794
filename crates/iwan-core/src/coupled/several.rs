//! Several joints in one step: Newton's method on the forces that slip takes off.
//!
//! With n = ΔN and s(n) = s + Δs* - c n the step is n = N(s(n)) - N(s). The gradient of the convex function
//! ½ nᵀ c n + Σ ∫ N ds along s(n) is c (n - ΔN(s(n))), and its Hessian c - c D c with D = K - dF/ds, so that Newton's
//! method with a line search finds the solution from anywhere, for a singular c as well: joints that move alike need
//! not be told apart.

use super::definite;
use super::joints::JointsInMotion;
use super::lanes::{Lanes, groups};
use super::modes::CoupledModes;
use crate::error::{Error, check_length};
use crate::line_search::search_line;
use crate::memory::Trial;

/// Rounds after which the method has failed, which is an error. Loads from micro-slip to far beyond macro-slip took up
/// to ten.
const MOST_ROUNDS: usize = 60;
/// The residual that rounding of the terms leaves, in units of their sum: eight times the machine precision.
const ROUNDING: f64 = 8.0 * f64::EPSILON;
/// After so many rounds the residual allowed doubles with each further one, up to [`MOST_ROUNDING`]: what is left then
/// is rounding of a law's own force.
const PATIENCE: usize = 20;
/// Worse than this is no rounding.
const MOST_ROUNDING: f64 = 1e-10;

/// Several joints of one kind of law and memory, whose trial points leave no trace.
#[derive(Debug)]
pub struct SeveralJoints<'a, J, State, S> {
    laws: &'a [J],
    states: &'a mut [State],
    /// For each joint: ΔN sought, residual, direction, ΔN at the start of a line, tangent missing, work.
    vectors: S,
    /// I - D^½ c D^½.
    matrix: S,
}

/// Rows in [`SeveralJoints::vectors`].
const ROWS: usize = 6;

impl<'a, State, J: Trial<State>, S: AsRef<[Lanes]> + AsMut<[Lanes]>> SeveralJoints<'a, J, State, S> {
    /// Laws and their states; `storage` gives room for so many groups.
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
        Ok(Self { laws, states, vectors: room(ROWS * j)?, matrix: room(j * j)? })
    }

    /// Solves with the compliance `c`, and moves the joints.
    fn step(&mut self, c: &[f64], stiffness: &[f64], ahead: &[f64]) -> Result<(), Error> {
        let j = self.laws.len();
        let Self { laws, states, vectors, matrix } = self;
        let (laws, states): (&[J], &mut [State]) = (laws, states);
        let matrix = &mut matrix.as_mut().as_flattened_mut()[..j * j];
        let mut rows = vectors.as_mut().as_flattened_mut()[..ROWS * j].chunks_exact_mut(j);
        let mut row = || rows.next().unwrap_or_default();
        let (n, residual, direction, start, slack, work) = (row(), row(), row(), row(), row(), row());
        let mut at = Iterate { c, stiffness, ahead, laws, states: &*states, allowed: ROUNDING };
        n.fill(0.0);
        let mut settled = at.evaluate(n, residual, slack);
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
            newton_direction(c, slack, residual, (matrix, work, direction));
            start.copy_from_slice(n);
            let slope = form(c, direction, residual);
            settled = search_line(slope, |length| {
                n.iter_mut().zip(&*start).zip(&*direction).for_each(|((n, s), d)| *n = s + length * d);
                (!at.evaluate(n, residual, slack)).then(|| form(c, direction, residual))
            });
        }
        for i in 0..j {
            let to = laws[i].displacement(&states[i]) + way(c, ahead, n, i);
            laws[i].advance(&mut states[i], to);
        }
        Ok(())
    }
}

/// Δs of joint `i`.
fn way(c: &[f64], ahead: &[f64], n: &[f64], i: usize) -> f64 {
    let row = &c[i * n.len()..(i + 1) * n.len()];
    ahead[i] - row.iter().zip(n).map(|(c, n)| c * n).sum::<f64>()
}

/// xᵀ c y.
fn form(c: &[f64], x: &[f64], y: &[f64]) -> f64 {
    let row = |i: usize| c[i * y.len()..(i + 1) * y.len()].iter().zip(y).map(|(c, y)| c * y).sum::<f64>();
    x.iter().enumerate().map(|(i, x)| x * row(i)).sum()
}

/// δ with (I - D c) δ = R, by way of the symmetric I - D^½ c D^½, which is positive definite: δ = R + D^½ w with
/// (I - D^½ c D^½) w = D^½ c R.
fn newton_direction(
    c: &[f64],
    slack: &[f64],
    residual: &[f64],
    (matrix, work, direction): (&mut [f64], &mut [f64], &mut [f64]),
) {
    let j = slack.len();
    for i in 0..j {
        let root = libm::sqrt(slack[i]);
        let row = &c[i * j..(i + 1) * j];
        work[i] = root * row.iter().zip(residual).map(|(c, r)| c * r).sum::<f64>();
        for l in 0..j {
            let unit = if i == l { 1.0 } else { 0.0 };
            matrix[i * j + l] = unit - root * row[l] * libm::sqrt(slack[l]);
        }
    }
    // By construction of the modes it is definite; were it not, the residual alone still leads downhill.
    if definite::factorise(j, matrix) {
        definite::solve(j, matrix, work);
    } else {
        work.fill(0.0);
    }
    for i in 0..j {
        direction[i] = residual[i] + libm::sqrt(slack[i]) * work[i];
    }
}

/// What the residual is made of.
struct Iterate<'a, J, State> {
    c: &'a [f64],
    stiffness: &'a [f64],
    ahead: &'a [f64],
    laws: &'a [J],
    states: &'a [State],
    /// Residual that counts as settled, in units of the sum of its terms.
    allowed: f64,
}

impl<State, J: Trial<State>> Iterate<'_, J, State> {
    /// Residual ΔN(s(n)) - n and D at `n`; returns whether rounding is all that is left.
    fn evaluate(&self, n: &[f64], residual: &mut [f64], slack: &mut [f64]) -> bool {
        let mut settled = true;
        for (i, (law, state)) in self.laws.iter().zip(self.states).enumerate() {
            let (way, k) = (way(self.c, self.ahead, n, i), self.stiffness[i]);
            let (from, before) = (law.displacement(state), law.joint_force(state));
            let (force, tangent) = law.trial(state, from + way);
            slack[i] = if tangent < k { k - tangent } else { 0.0 };
            residual[i] = ((force - before) - k * way) - n[i];
            let terms = force.abs() + before.abs() + k * (way.abs() + from.abs()) + n[i].abs();
            settled &= residual[i].abs() <= self.allowed * terms;
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
        let j = self.laws.len();
        change.copy_from_slice(&self.vectors.as_ref().as_flattened()[..j]);
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
        self.laws[index].displacement(&self.states[index])
    }

    fn force(&self, index: usize) -> f64 {
        self.laws[index].joint_force(&self.states[index])
    }

    fn stored_energy(&self, index: usize) -> f64 {
        self.laws[index].stored_energy(&self.states[index])
    }
}
