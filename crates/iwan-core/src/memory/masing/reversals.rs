//! The stack of reversals: where loops begin, where they close, and when they are forgotten.

use super::branch::{Branch, Reversal};
use crate::law::Backbone;

/// The state of a [`Continuum`](crate::Continuum): displacement, force, and the reversal points that still matter.
///
/// `S` holds the stack: an array makes the state `Copy`, a slice or vector lends the caller's memory. A decaying oscillation adds one entry
/// per half cycle. When the stack is full, the innermost loop is forgotten and [`forgotten`](Self::forgotten) grows by the largest force
/// error that this can cause.
#[derive(Debug, Clone, Copy)]
pub struct Reversals<S> {
    pub(super) u: f64,
    pub(super) force: f64,
    pub(super) tangent: f64,
    pub(super) branch: Branch,
    /// Force and tangent at the expected end of the next implicit step, on the present branch; NaN when there is no expectation.
    pub(super) prepared: Prepared,
    /// Displacement before the last implicit step, and its first, second and third backward differences.
    trail: [f64; 4],
    /// Displacement at which the virgin curve starts; macro-slip moves it.
    pub(super) origin: f64,
    /// Number of reversals remembered.
    pub(super) depth: usize,
    forgotten: f64,
    pub(super) stack: S,
}

/// Force and tangent of the present branch at a displacement that the motion has not reached yet.
#[derive(Debug, Clone, Copy)]
pub(super) struct Prepared {
    pub(super) u: f64,
    pub(super) force: f64,
    pub(super) tangent: f64,
}

impl Prepared {
    pub(super) const NOTHING: Self = Self { u: f64::NAN, force: f64::NAN, tangent: f64::NAN };
}

impl<S> Reversals<S> {
    /// The virgin state again, in the same memory, for a law with this initial stiffness.
    pub(crate) fn into_virgin(self, initial_stiffness: f64) -> Self {
        Self::virgin(self.stack, initial_stiffness)
    }

    /// The virgin state of a law of this initial stiffness.
    pub(super) fn virgin(stack: S, initial_stiffness: f64) -> Self {
        let (u, force, origin, depth, forgotten) = (0.0, 0.0, 0.0, 0, 0.0);
        Self {
            u,
            force,
            tangent: initial_stiffness,
            branch: Branch::virgin(origin, 1.0),
            prepared: Prepared::NOTHING,
            trail: [0.0; 4],
            origin,
            depth,
            forgotten,
            stack,
        }
    }
}

impl<S: AsRef<[Reversal]> + AsMut<[Reversal]>> Reversals<S> {
    /// Passes every number of the state to `see`, as [`Runs::each_number`](crate::Runs::each_number) does.
    ///
    /// ```
    /// use iwan_core::{Continuum, FourParameter, Hysteresis, Reversal};
    /// let joint = Continuum::new(FourParameter::new(1.0, 1.0, -0.5, 0.1)?);
    /// let [mut state, mut other] = [joint.virgin([Reversal::default(); 8])?; 2];
    /// [0.5, -0.3, 0.2].map(|u| joint.advance(&mut state, u));
    /// let mut numbers = vec![];
    /// state.each_number(&mut |x| numbers.push(*x));
    /// let mut written = numbers.into_iter();
    /// other.each_number(&mut |x| *x = written.next().unwrap());
    /// assert_eq!(joint.advance(&mut other, 0.9), joint.advance(&mut state, 0.9));
    /// # Ok::<(), iwan_core::Error>(())
    /// ```
    pub fn each_number(&mut self, see: &mut dyn FnMut(&mut f64)) {
        [&mut self.u, &mut self.force, &mut self.tangent].into_iter().for_each(&mut *see);
        self.branch.each_number(see);
        let Prepared { u, force, tangent } = &mut self.prepared;
        [u, force, tangent].into_iter().for_each(&mut *see);
        self.trail.iter_mut().for_each(&mut *see);
        [&mut self.origin, &mut self.forgotten].into_iter().for_each(&mut *see);
        let mut depth = self.depth as f64;
        see(&mut depth);
        self.depth = (depth as usize).min(self.stack.as_ref().len());
        for Reversal { u, force } in &mut self.stack.as_mut()[..self.depth] {
            [u, force].into_iter().for_each(&mut *see);
        }
    }

    /// Bound on the force error from loops that were forgotten because the stack was full; 0 means exact.
    ///
    /// Sliders are non-expansive: two histories of one population never drift apart. So the force error at the moment of forgetting bounds
    /// all later errors, and the errors of several moments add.
    pub const fn forgotten(&self) -> f64 {
        self.forgotten
    }

    /// Direction of motion, ±1.
    pub(crate) const fn direction(&self) -> f64 {
        self.branch.direction
    }

    /// The branch on which the state moves, by reference.
    #[inline]
    pub(crate) fn branch_ref(&self) -> &Branch {
        &self.branch
    }

    /// The branch on which the state moves, as a copy.
    #[inline]
    pub(crate) fn branch(&self) -> Branch {
        self.branch
    }

    /// The branch in `direction` with `depth` reversals remembered.
    #[inline]
    pub(super) fn branch_at(&self, depth: usize, direction: f64) -> Branch {
        if depth == 0 {
            return Branch::virgin(self.origin, direction);
        }
        let start = self.stack.as_ref()[depth - 1];
        // The loop around the first reversal closes at its mirror image on the virgin curve.
        let end = if depth == 1 { 2.0 * self.origin - start.u } else { self.stack.as_ref()[depth - 2].u };
        Branch::behind(start, direction, end)
    }

    /// Puts the state at `u` on the present branch, with the force and tangent there.
    #[inline]
    pub(crate) fn rest_at(&mut self, u: f64, (force, tangent): (f64, f64)) {
        (self.u, self.force, self.tangent) = (u, force, tangent);
    }

    /// Evaluates the branch at the expected end of the step after this one, extrapolated by the cubic through the last four displacements,
    /// two steps on. The evaluation needs no result of the present step, so the processor can do both at once.
    #[inline]
    pub(super) fn look_ahead<B: Backbone>(&mut self, law: &B) -> Prepared {
        let [a, first, second, _] = self.trail;
        let da = self.u - a;
        let (dda, ddda) = (da - first, (da - first) - second);
        self.trail = [self.u, da, dda, ddda];
        let u = (self.u + 2.0 * da) + (3.0 * dda + 4.0 * ddda);
        let (force, tangent) = self.branch.force_and_tangent(law, u);
        Prepared { u, force, tangent }
    }

    /// Forgets the loops that a motion up to `u` closes, and returns the branch that holds at `u`.
    #[inline]
    pub(crate) fn close_loops_before(&mut self, u: f64) -> Branch {
        while self.branch.passed_by(u) {
            self.forget_closed_loop();
        }
        self.branch
    }

    /// Continues behind the end of a branch: the loop that closes there is forgotten.
    pub(crate) fn forget_closed_loop(&mut self) {
        self.depth = self.depth.saturating_sub(2);
        self.branch = self.branch_at(self.depth, self.branch.direction);
        self.prepared = Prepared::NOTHING;
    }

    /// Reverses the direction of motion at the present displacement.
    pub(crate) fn reverse<B: Backbone>(&mut self, law: &B) {
        self.prepared = Prepared::NOTHING;
        let travelled = self.branch.virgin_distance(self.u);
        let (direction, strongest) = (self.branch.direction, law.strengths().1);
        if travelled == 0.0 {
            // The motion has gone no way since the last reversal, so that reversal is undone.
            self.depth = self.depth.saturating_sub(1);
            self.branch = self.branch_at(self.depth, -direction);
            self.tangent = self.branch.force_and_tangent(law, self.u).1;
        } else {
            if travelled >= strongest {
                // Macro-slip erases the memory; the virgin curve now starts φ_max behind the present point.
                (self.depth, self.origin) = (0, self.u - direction * strongest);
            }
            self.turn(law);
        }
    }

    /// Moves to `u` on the present branch, where the force is `force`, and turns round. `u` must lie before the end of the branch and
    /// before macro-slip; the checks of [`reverse`](Self::reverse) are left out.
    #[inline]
    pub(crate) fn turn_within<B: Backbone>(&mut self, u: f64, force: f64, law: &B) {
        (self.u, self.force, self.prepared) = (u, force, Prepared::NOTHING);
        self.turn(law);
    }

    /// Stores the present point as a reversal and starts the branch in the other direction.
    #[inline]
    fn turn<B: Backbone>(&mut self, law: &B) {
        let direction = self.branch.direction;
        if self.depth == self.stack.as_ref().len() {
            self.forget_innermost(law, direction);
        }
        self.stack.as_mut()[self.depth] = Reversal { u: self.u, force: self.force };
        self.depth += 1;
        self.branch = self.branch_at(self.depth, -direction);
        self.tangent = law.initial_stiffness();
    }

    /// Makes room by dropping the smallest loop as if it had closed.
    #[cold]
    fn forget_innermost<B: Backbone>(&mut self, law: &B, direction: f64) {
        self.depth -= 2;
        let (merged, _) = self.branch_at(self.depth, direction).force_and_tangent(law, self.u);
        self.forgotten += (merged - self.force).abs();
        self.force = merged;
    }
}
