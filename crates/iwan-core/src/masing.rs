//! The continuum: Masing's rule with return-point memory, exact and without sliders.
//!
//! The state is a stack of reversal points. On the branch that left the latest one,
//! (u_a, F_a), in direction d, the force is F_a + 2 d F_virgin(|u - u_a|/2); where the branch
//! meets the reversal before, that loop closes, both points are forgotten and the outer branch
//! goes on (G. Masing, 1926; D. J. Segalman and M. J. Starr, Int. J. Non-Linear Mech. 43:74, 2008,
//! doi:10.1016/j.ijnonlinmec.2007.10.010). The outermost loop closes on the virgin curve.

mod trial;

use crate::backbone::Backbone;
use crate::error::Error;
use crate::hysteresis::Hysteresis;

/// A point at which the motion turned round.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Reversal {
    /// Displacement there.
    pub(crate) u: f64,
    /// Force there.
    pub(crate) force: f64,
}

/// The state of a [`Continuum`]: where it stands and the reversal points not yet forgotten.
///
/// `S` holds the stack: an array makes the state `Copy`, a slice or vector lends the caller's
/// memory. A decaying oscillation adds one entry per half cycle. When the stack is full the
/// innermost loop is forgotten and [`forgotten`](Self::forgotten) grows by the force that this may cost.
#[derive(Debug, Clone, Copy)]
pub struct Reversals<S> {
    u: f64,
    force: f64,
    tangent: f64,
    branch: Branch,
    /// Where the next implicit step should end, evaluated on the present branch; NaN when that is not known.
    prepared: Prepared,
    /// Displacement before the last implicit step and its backward differences.
    trail: [f64; 4],
    /// Displacement at which the virgin curve starts: moved by macro-slip.
    origin: f64,
    depth: usize,
    forgotten: f64,
    stack: S,
}

/// An evaluation of the present branch ahead of the motion.
#[derive(Debug, Clone, Copy)]
struct Prepared {
    u: f64,
    force: f64,
    tangent: f64,
}

impl Prepared {
    const NOTHING: Self = Self { u: f64::NAN, force: f64::NAN, tangent: f64::NAN };
}

/// The branch on which a state moves.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Branch {
    /// Where it left.
    pub(crate) start: Reversal,
    /// 2 behind a reversal (Masing), 1 on the virgin curve.
    pub(crate) scale: f64,
    /// Direction of motion over scale: turns displacements into those of the virgin curve.
    to_virgin: f64,
    /// Direction of motion, ±1.
    pub(crate) direction: f64,
    /// Where it closes a loop and ends (infinite on the virgin curve).
    pub(crate) end: f64,
}

impl Branch {
    /// The virgin curve from `origin`.
    fn virgin(origin: f64, direction: f64) -> Self {
        let start = Reversal { u: origin, force: 0.0 };
        Self { start, scale: 1.0, to_virgin: direction, direction, end: direction * f64::INFINITY }
    }

    /// Displacement on the virgin curve that corresponds to `u`, >= 0.
    #[inline]
    pub(crate) fn virgin_distance(&self, u: f64) -> f64 {
        let distance = self.to_virgin * (u - self.start.u);
        // `f64::max` would ask for NaN as well.
        if distance > 0.0 { distance } else { 0.0 }
    }

    #[inline]
    pub(crate) fn force_and_tangent<B: Backbone>(&self, law: &B, u: f64) -> (f64, f64) {
        let (force, tangent) = law.force_and_tangent(self.virgin_distance(u));
        (self.start.force + self.scale * self.direction * force, tangent)
    }

    /// Whether the branch left at `u`.
    pub(crate) fn start_is(&self, u: f64) -> bool {
        self.start.u == u
    }

    /// Work ∫F du from the start of the branch to `u`.
    pub(crate) fn work<B: Backbone>(&self, law: &B, u: f64) -> f64 {
        self.start.force * (u - self.start.u) + self.scale * self.scale * law.energy(self.virgin_distance(u))
    }

    /// Whether `u` lies beyond the end.
    #[inline]
    pub(crate) fn passed_by(&self, u: f64) -> bool {
        self.direction * (u - self.end) > 0.0
    }
}

/// A closed-form law evaluated by return-point memory.
///
/// ```
/// use iwan_core::{Backbone, Continuum, FourParameter, Hysteresis, Reversal};
/// let joint = FourParameter::new(4.45e4, 239.4, -0.183, 0.3)?;
/// let law = Continuum::new(joint);
/// let mut state = law.virgin([Reversal::default(); 16])?;
/// let top = law.advance(&mut state, 4e-3);
/// let down = law.advance(&mut state, 1e-3);
/// assert!((down - (top - 2.0 * joint.force(1.5e-3))).abs() < 1e-10); // Masing
/// # Ok::<(), iwan_core::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Continuum<B> {
    law: B,
}

impl<B: Backbone> Continuum<B> {
    /// The continuum of a law.
    #[must_use]
    pub const fn new(law: B) -> Self {
        Self { law }
    }

    /// The law.
    pub const fn law(&self) -> &B {
        &self.law
    }

    /// The virgin state, with room for `stack.len()` >= 3 reversals.
    ///
    /// # Errors
    /// [`Error::Length`].
    pub fn virgin<S: AsMut<[Reversal]>>(&self, mut stack: S) -> Result<Reversals<S>, Error> {
        let found = stack.as_mut().len();
        if found < 3 {
            return Err(Error::Length { name: "stack", needed: 3, found });
        }
        let tangent = self.law.initial_stiffness();
        let (u, force, origin, depth, forgotten) = (0.0, 0.0, 0.0, 0, 0.0);
        Ok(Reversals {
            u,
            force,
            tangent,
            branch: Branch::virgin(origin, 1.0),
            prepared: Prepared::NOTHING,
            trail: [0.0; 4],
            origin,
            depth,
            forgotten,
            stack,
        })
    }
}

impl<S: AsRef<[Reversal]> + AsMut<[Reversal]>> Reversals<S> {
    /// Bound on the force error from loops forgotten because the stack was full; 0 = exact.
    ///
    /// Sliders are non-expansive: two histories of one population never drift apart, so the force gap at
    /// the moment of forgetting bounds all later ones, and the gaps add.
    pub const fn forgotten(&self) -> f64 {
        self.forgotten
    }

    /// Direction of motion, ±1.
    pub(crate) const fn direction(&self) -> f64 {
        self.branch.direction
    }

    /// The branch on which the state moves, where it is kept.
    #[inline]
    pub(crate) fn branch_ref(&self) -> &Branch {
        &self.branch
    }

    /// The branch on which the state moves.
    #[inline]
    pub(crate) fn branch(&self) -> Branch {
        self.branch
    }

    /// The branch in `direction` with `depth` reversals remembered.
    #[inline]
    fn branch_at(&self, depth: usize, direction: f64) -> Branch {
        if depth == 0 {
            return Branch::virgin(self.origin, direction);
        }
        let start = self.stack.as_ref()[depth - 1];
        // The loop around the first reversal closes at its mirror image on the virgin curve.
        let end = if depth == 1 { 2.0 * self.origin - start.u } else { self.stack.as_ref()[depth - 2].u };
        Branch { start, scale: 2.0, to_virgin: 0.5 * direction, direction, end }
    }

    /// Puts the state at `u` on the present branch, with the force and tangent there.
    #[inline]
    pub(crate) fn rest_at(&mut self, u: f64, (force, tangent): (f64, f64)) {
        (self.u, self.force, self.tangent) = (u, force, tangent);
    }

    /// The cubic through the trail of steps, two steps on, tells where the step after the one that now begins
    /// should end: its evaluation waits for nothing that this step has to find.
    #[inline]
    fn look_ahead<B: Backbone>(&mut self, law: &B) -> Prepared {
        let [a, first, second, _] = self.trail;
        let da = self.u - a;
        let (dda, ddda) = (da - first, (da - first) - second);
        self.trail = [self.u, da, dda, ddda];
        let u = (self.u + 2.0 * da) + (3.0 * dda + 4.0 * ddda);
        let (force, tangent) = self.branch.force_and_tangent(law, u);
        Prepared { u, force, tangent }
    }

    /// Forgets the loops that motion up to `u` closes and returns the branch that holds there.
    #[inline]
    pub(crate) fn close_loops_before(&mut self, u: f64) -> Branch {
        while self.branch.passed_by(u) {
            self.forget_closed_loop();
        }
        self.branch
    }

    /// Goes on behind the end of a branch: the loop that closes there is forgotten.
    pub(crate) fn forget_closed_loop(&mut self) {
        self.depth = self.depth.saturating_sub(2);
        self.branch = self.branch_at(self.depth, self.branch.direction);
        self.prepared = Prepared::NOTHING;
    }

    /// Turns round where the state stands.
    pub(crate) fn reverse<B: Backbone>(&mut self, law: &B) {
        self.prepared = Prepared::NOTHING;
        let travelled = self.branch.virgin_distance(self.u);
        let (direction, strongest) = (self.branch.direction, law.strengths().1);
        if travelled == 0.0 {
            // No way gone since the last reversal: it is undone.
            self.depth = self.depth.saturating_sub(1);
            self.branch = self.branch_at(self.depth, -direction);
            self.tangent = self.branch.force_and_tangent(law, self.u).1;
        } else {
            if travelled >= strongest {
                // Macro-slip wipes the memory; the virgin curve now starts φ_max behind.
                (self.depth, self.origin) = (0, self.u - direction * strongest);
            }
            self.turn(law);
        }
    }

    /// Moves to `u`, short of the strongest slider and of the end of the branch, where the force is `force`, and turns
    /// round: [`reverse`](Self::reverse) without its questions.
    #[inline]
    pub(crate) fn turn_within<B: Backbone>(&mut self, u: f64, force: f64, law: &B) {
        (self.u, self.force, self.prepared) = (u, force, Prepared::NOTHING);
        self.turn(law);
    }

    /// Remembers the present point and leaves it the other way.
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

impl<B: Backbone> Continuum<B> {
    /// Whether neither the weakest nor the strongest slider breaks loose between `a` and `b`.
    #[inline]
    fn no_corner(&self, branch: &Branch, a: f64, b: f64) -> bool {
        let (weakest, strongest) = self.law.strengths();
        let (a, b) = (branch.virgin_distance(a), branch.virgin_distance(b));
        let inside = |x: f64| x >= weakest && x < strongest;
        (inside(a) && inside(b)) || ((a < weakest) == (b < weakest) && (a < strongest) == (b < strongest))
    }
}

/// Newton's second-order error is accepted below this share of the step: the force is then
/// exact to rounding.
const NEWTON_ERROR: f64 = 1e-18;

/// Newton's method needs a handful of rounds; a law so crooked that this many do not do is met as well as they did.
const MOST_ROUNDS: u32 = 100;

impl<B: Backbone, S: AsRef<[Reversal]> + AsMut<[Reversal]>> Hysteresis<Reversals<S>> for Continuum<B> {
    fn displacement(&self, state: &Reversals<S>) -> f64 {
        state.u
    }

    #[inline]
    fn joint_force(&self, state: &Reversals<S>) -> f64 {
        state.force
    }

    fn advance(&self, state: &mut Reversals<S>, u: f64) -> f64 {
        let du = u - state.u;
        if du != 0.0 && du.is_finite() {
            if du * state.branch.direction < 0.0 {
                state.reverse(&self.law);
            }
            let branch = state.close_loops_before(u);
            state.rest_at(u, branch.force_and_tangent(&self.law, u));
        }
        state.force
    }

    /// Newton's method: along a monotone motion the force is concave, loops closing included, so that after one
    /// round the iteration stands short of the solution and never passes it; trial points touch no state but
    /// the loops that the solution closes as well. It starts from the trail of past displacements, known
    /// well before `load` is: at the small steps of a ring-down one evaluation does, and nothing waits for it.
    #[inline]
    fn solve(&self, state: &mut Reversals<S>, stiffness: f64, load: f64) -> f64 {
        if load == 0.0 {
            return 0.0;
        }
        let next = if self.law.is_smooth() { state.look_ahead(&self.law) } else { Prepared::NOTHING };
        let mut at = core::mem::replace(&mut state.prepared, next);
        if load * state.branch.direction < 0.0 {
            state.reverse(&self.law);
            at = Prepared::NOTHING;
        }
        let (u, force, tangent) = (state.u, state.force, state.tangent);
        let mut branch = state.branch;
        let ahead = branch.direction * (at.u - u) > 0.0 && branch.direction * (branch.end - at.u) >= 0.0;
        if !ahead {
            at.u = u + load / (stiffness + tangent);
            branch = state.close_loops_before(at.u);
            (at.force, at.tangent) = branch.force_and_tangent(&self.law, at.u);
        }
        for round in 0.. {
            let Prepared { u: trial, force: trial_force, tangent: k } = at;
            let inverse = 1.0 / (stiffness + k);
            let way = trial - u;
            let step = (load - stiffness * way - (trial_force - force)) * inverse;
            let error = ((tangent - k) * step * step).abs();
            let du = way + step;
            let small = step.abs() <= f64::EPSILON * du.abs();
            let accurate = error <= NEWTON_ERROR * (stiffness * du * way).abs()
                && self.no_corner(&branch, trial, u + du);
            if (small || accurate) && !branch.passed_by(u + du) {
                state.rest_at(u + du, (trial_force + k * step, k));
                return du;
            }
            // Where rounding of forces and displacements hides the rest, Newton's method has nothing left to find.
            let force_scale = load.abs() + force.abs() + trial_force.abs();
            let noise = 4.0 * f64::EPSILON * (u.abs() + trial.abs() + force_scale * inverse);
            if step.abs() <= noise || round == MOST_ROUNDS {
                state.rest_at(u + du, (trial_force + k * step, k));
                return du;
            }
            if !step.is_finite() {
                break;
            }
            at.u = u + du;
            branch = state.close_loops_before(at.u);
            (at.force, at.tangent) = branch.force_and_tangent(&self.law, at.u);
        }
        f64::NAN
    }

    /// ½∫ρ x², range by range of the sliders that last slipped together: those weaker than the
    /// way of the present branch, then those between the ways of two successive branches.
    fn stored_energy(&self, state: &Reversals<S>) -> f64 {
        let mut energy = 0.0;
        let mut low = [0.0; 3];
        let (mut sign, mut anchor, mut until) = (state.branch.direction, None, state.u);
        for depth in (0..=state.depth).rev() {
            let branch = state.branch_at(depth, sign);
            let high = moments(&self.law, branch.virgin_distance(until));
            energy += range_energy(sign, anchor.map_or(0.0, |a: f64| state.u - a), low, high);
            low = high;
            (sign, anchor, until) = (-sign, Some(branch.start.u), branch.start.u);
        }
        // Sliders that never slipped follow the displacement.
        energy + range_energy(0.0, state.u - state.origin, low, moments(&self.law, f64::INFINITY))
    }
}

/// ∫ρ, ∫ρφ and ∫ρφ² of the strengths below `phi`.
fn moments<B: Backbone>(law: &B, phi: f64) -> [f64; 3] {
    let strongest = law.strengths().1;
    if phi >= strongest {
        let slip = law.slip_force();
        return [law.initial_stiffness(), slip, strongest * slip - 0.25 * law.dissipation(strongest)];
    }
    let below = law.force_below(phi);
    [law.stiffness_below(phi), below, phi * below - 0.25 * law.dissipation(phi)]
}

/// ½∫ρ (s φ + w)² between two strengths, from the moments below them.
fn range_energy(s: f64, w: f64, low: [f64; 3], high: [f64; 3]) -> f64 {
    let [m0, m1, m2] = [high[0] - low[0], high[1] - low[1], high[2] - low[2]];
    0.5 * (s * s * m2 + 2.0 * s * w * m1 + w * w * m0)
}
