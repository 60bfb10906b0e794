//! Motion between turning points where the half-cycle map does not apply: adaptive integration on the branch, loop by loop.

use super::decay::Decay;
use super::dormand_prince::{self, Moment, Step};
use crate::law::Backbone;
use crate::memory::{Branch, Reversal};

/// Largest number of rounds in the search for a turning point or for the end of a loop. Newton's method takes a few. Where rounding of the
/// motion hides the zero, the bracket is halved until the limit is reached; it is then 1e-18 of the step.
const MOST_BISECTIONS: u32 = 60;

/// Longest Runge-Kutta step, rad of the mode at small amplitude; the tolerance usually asks for shorter ones. From 0.02 to 0.2 neither the
/// number of steps nor the error changes by much. [`MOST_STEPS`] counts steps of this length.
const LONGEST_ANGLE: f64 = 0.05;

/// Shortest step that the tolerance may ask for, relative to the longest. Where rounding of the acceleration hides the error, steps would
/// otherwise shrink without end; a step of this length is always accepted. Any value from 1e-8 to 1e-2 does.
const SHORTEST: f64 = 1e-6;

/// Number of steps after which a motion without reversal counts as creeping, and the decay ends. At [`LONGEST_ANGLE`] they are 50,000 rad,
/// 8,000 periods of the mode.
const MOST_STEPS: u32 = 1_000_000;

/// Allowed relative error of the velocity per Runge-Kutta step. With it the first turning point is exact to 2e-12 in macro-slip and to
/// 1e-14 in micro-slip; ten times the tolerance loses a digit and saves a third of the steps.
const STEP_TOLERANCE: f64 = 1e-13;

/// A function of the motion whose zero is sought, and its rate of change in time.
struct Crossing {
    value: f64,
    rate: f64,
}

impl<B: Backbone, S: AsRef<[Reversal]> + AsMut<[Reversal]>> Decay<'_, B, S> {
    /// Integrates up to the time `until` (returns false) or to the next reversal (returns true); returns false also at rest.
    pub(super) fn march(&mut self, until: f64) -> bool {
        let longest = LONGEST_ANGLE / libm::sqrt(self.map.k_inf + self.map.law.initial_stiffness());
        let mut h = longest;
        if self.now.v == 0.0 && self.acceleration(&self.memory.branch(), self.now.q, 0.0) == 0.0 {
            return false;
        }
        for _ in 0..MOST_STEPS {
            if self.now.time >= until {
                return false;
            }
            let branch = self.memory.branch();
            h = h.min(until - self.now.time).min(longest);
            let Step { end: next, error } = self.step(&branch, h);
            let scale = libm::fabs(self.now.v) + libm::fabs(next.v) + f64::MIN_POSITIVE;
            let shrink = libm::pow(STEP_TOLERANCE * scale / (error + f64::MIN_POSITIVE), 0.2);
            let (force, _) = branch.force_and_tangent(self.map.law, next.q);
            let forces = libm::fabs(self.map.k_inf * next.q) + libm::fabs(force) + libm::fabs(self.map.load);
            let noise = f64::EPSILON * forces * h;
            if error > STEP_TOLERANCE * scale + noise && h > SHORTEST * longest {
                h *= (0.9 * shrink).clamp(0.1, 0.9);
                continue;
            }
            let turns = branch.direction * next.v <= 0.0;
            let closes = branch.passed_by(next.q);
            if !(turns || closes) {
                self.accept(&branch, next);
                h *= (0.9 * shrink).clamp(0.5, 4.0);
                continue;
            }
            let turning = turns.then(|| {
                self.locate(&branch, h, |m| Crossing {
                    value: m.v,
                    rate: self.acceleration(&branch, m.q, m.v),
                })
            });
            let closing =
                closes.then(|| self.locate(&branch, h, |m| Crossing { value: m.q - branch.end, rate: m.v }));
            match (turning, closing) {
                (Some(t), c) if c.is_none_or(|c| t.time <= c.time) => {
                    self.accept(&branch, Moment { v: 0.0, ..t });
                    self.memory.reverse(self.map.law);
                    self.set_out();
                    return true;
                }
                (_, Some(c)) => {
                    self.accept(&branch, Moment { q: branch.end, ..c });
                    self.memory.forget_closed_loop();
                }
                _ => return false,
            }
        }
        false
    }

    /// Accepts the end of a step and adds the works, by Simpson's rule on the step's midpoint.
    fn accept(&mut self, branch: &Branch, next: Moment) {
        let middle = self.step(branch, 0.5 * (next.time - self.now.time)).end;
        let power = |v: f64| v * v * self.map.viscous;
        let h = next.time - self.now.time;
        self.works.force += self.map.load * (next.q - self.now.q);
        self.works.damper += h / 6.0 * (power(self.now.v) + 4.0 * power(middle.v) + power(next.v));
        self.works.joint += branch.work(self.map.law, next.q) - branch.work(self.map.law, self.now.q);
        self.memory.rest_at(next.q, branch.force_and_tangent(self.map.law, next.q));
        self.now = next;
    }

    /// The moment within a step of length `h` at which a function of the motion crosses zero, by Newton's method on steps from the present
    /// state; a round that would leave the bracket bisects it instead.
    fn locate(&self, branch: &Branch, h: f64, f: impl Fn(&Moment) -> Crossing) -> Moment {
        let (mut low, mut high, mut at) = (0.0, h, h);
        let sign = f(&self.step(branch, h).end).value;
        for _ in 0..MOST_BISECTIONS {
            let Crossing { value, rate } = f(&self.step(branch, at).end);
            if value * sign > 0.0 {
                high = at;
            } else {
                low = at;
            }
            let newton = at - value / rate;
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            if libm::fabs(next - at) <= 4.0 * f64::EPSILON * h {
                break;
            }
            at = next;
        }
        self.step(branch, at).end
    }

    /// One Runge-Kutta step of length `h` (s) from the present state, on the present branch.
    fn step(&self, branch: &Branch, h: f64) -> Step {
        dormand_prince::step(self.now, h, |q, v| self.acceleration(branch, q, v))
    }
}
