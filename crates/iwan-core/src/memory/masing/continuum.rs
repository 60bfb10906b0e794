//! The continuous law under Masing's rule: explicit and implicit steps, stored energy.

use super::branch::{Branch, Reversal};
use super::reversals::{Prepared, Reversals};
use crate::error::Error;
use crate::law::{Backbone, check_masing};
use crate::memory::hysteresis::Hysteresis;

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
    /// [`Error::Length`]; [`Error::Unsupported`] for a law that does not obey Masing's rule.
    pub fn virgin<S: AsMut<[Reversal]>>(&self, mut stack: S) -> Result<Reversals<S>, Error> {
        check_masing(&self.law)?;
        let found = stack.as_mut().len();
        if found < 3 {
            return Err(Error::Length { name: "stack", needed: 3, found });
        }
        Ok(Reversals::virgin(stack, self.law.initial_stiffness()))
    }
}

impl<B: Backbone> Continuum<B> {
    /// Whether no corner of the virgin curve (the weakest or the strongest slider breaking loose) lies between `a` and `b`.
    #[inline]
    fn no_corner(&self, branch: &Branch, a: f64, b: f64) -> bool {
        let (weakest, strongest) = self.law.strengths();
        let (a, b) = (branch.virgin_distance(a), branch.virgin_distance(b));
        let inside = |x: f64| x >= weakest && x < strongest;
        (inside(a) && inside(b)) || ((a < weakest) == (b < weakest) && (a < strongest) == (b < strongest))
    }
}

/// Newton's method ends when the change of the force expected from its next round is below this share of the step's `stiffness`·Δu. The
/// expected change is estimated from how the tangent changed over the step. The share is far below rounding (1e-16) because the estimate is
/// rough near a reversal, where the curvature is infinite for χ < 0. From 1e-14 to 1e-18 responses differ by rounding and take the same
/// time; 1e-12 leaves errors of 4e-12 at long steps, and from 1e-20 on most steps need a second evaluation.
const NEWTON_ERROR: f64 = 1e-18;

/// Rounding, in units in the last place of displacements and forces, below which a correction of the step is meaningless. When a correction
/// falls below it, the iteration ends. Without this bound, steps of a motion that has died away oscillate within their rounding until
/// [`MOST_ROUNDS`] end them; with any value from 1 to 16 they end within three rounds.
const ROUNDING: f64 = 4.0;

/// Largest distance of a trial point from the start, in lengths of the step, from which the solution is accepted. From a trial point this
/// many steps away, the correction back to the solution multiplies rounding by the same factor: sixteen lose four of 53 bits. A judgement;
/// not varied. Beyond it one more round is made.
const FAR: f64 = 16.0;

/// Largest number of rounds of Newton's method; a handful is usual. If a very irregular law needs more, the step ends with the result of
/// the last round, and the time stepping goes on.
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

    /// One implicit step by Newton's method. Along a monotone motion the force is concave, even where loops close. So after one round the
    /// iteration stands short of the solution and never passes it: a trial point closes only loops that the solution closes as well, and
    /// the state need not be restored.
    ///
    /// The first trial point is extrapolated from the past displacements, and the force at that point was evaluated during the step before.
    /// In a ring-down at small steps no other evaluation is needed, so the processor does not wait for one.
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
            // If the trial point coincides with the start but for rounding, the two tangents say nothing of a step beyond it.
            let accurate = step.abs() <= way.abs()
                && way.abs() <= FAR * du.abs()
                && error <= NEWTON_ERROR * (stiffness * du * way).abs()
                && self.no_corner(&branch, trial, u + du);
            if (small || accurate) && !branch.passed_by(u + du) {
                state.rest_at(u + du, (trial_force + k * step, k));
                return du;
            }
            // Rounding of forces and displacements hides what is left, and further rounds would oscillate within it.
            let force_scale = load.abs() + force.abs() + trial_force.abs();
            let noise = ROUNDING * f64::EPSILON * (u.abs() + trial.abs() + force_scale * inverse);
            if step.abs() <= noise || round == MOST_ROUNDS {
                // The load pushes on: a way back is rounding and nothing else.
                if branch.direction * du < 0.0 {
                    state.rest_at(u, (force, tangent));
                    return 0.0;
                }
                state.rest_at(u + du, (trial_force + k * step, k));
                return du;
            }
            if !step.is_finite() {
                break;
            }
            // From a trial point beyond the solution, where the tangent is small, Newton's step may lead back behind the start, where the
            // branch does not exist. A step with the stiffness of the virgin joint never passes the solution, so it replaces Newton's step.
            let behind = branch.direction * du < 0.0;
            at.u = u + if behind { load / (stiffness + self.law.initial_stiffness()) } else { du };
            branch = state.close_loops_before(at.u);
            (at.force, at.tangent) = branch.force_and_tangent(&self.law, at.u);
        }
        f64::NAN
    }

    /// ½∫ρ x², summed over ranges of sliders that last slipped together: first the sliders weaker than the way travelled on the present
    /// branch, then those between the ways of successive branches.
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
