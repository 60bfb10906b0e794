//! Time steps by average acceleration for a mode with a joint and parts.
//!
//! One step of length h solves for the increment x = Δq, with the velocity v_1 = 2x/h - v_0,
//!
//! (4/h² + 2c/h + K_∞) x + F_J(q_0 + x) - F_J(q_0) + 2 G(q_0, q_0 + x) + 2 d(x/h) + 2 s F =
//! σ (p_0 + p_1) + 4v_0/h - 2 K_∞ q_0 - 2 F_J(q_0).
//!
//! G is the mean force of the springs over the step's displacement (work over distance), so that the step takes from the motion exactly the
//! energy that the springs gain (O. Gonzalez, Time integration and discrete Hamiltonian systems, J. Nonlinear Sci. 6:449, 1996, in one
//! dimension). d is the force of the dampers at the mean velocity x/h, so that they never give energy back, and a mode that creeps under a
//! damper with n < 1 creeps at the right speed (with the mean of the forces at both ends it would creep twice as fast). s F is dry friction
//! in the direction s of the motion, and σ the prewarping factor. A joint whose force jumps within the step also enters by its mean force
//! ([`Trial::mean_beyond_ends`]): with the mean of both ends a jump would cause an error of first order in the step.
//!
//! Dry friction is set-valued at rest and is not smoothed. A step in which the velocity changes its sign is cut where the velocity
//! vanishes. There the mode sticks while the other forces on it are at most F, and slides on in the direction of those forces when they
//! exceed F. Between two such points the friction is constant, so a linear mode with dry friction is computed as exactly as without.

use super::energy::{EnergyBalance, JointEnergy, Works};
use super::motion::Motion;
use super::newmark::Newmark;
use super::oscillator::Oscillator;
use super::response::{Samples, force_at};
use crate::error::Error;
use crate::memory::Trial;
use crate::parts::{Part, sum_of_parts};

/// Largest number of rounds of Newton's method in a step; usually it takes three or four, and it bisects where it would leave the bracket.
/// From an increment as large as the motion, 100 bisections leave less than rounding, so the last value is used.
const MOST_ROUNDS: u32 = 100;
/// Units in the last place of a step's forces below which a correction is rounding; the iteration then ends.
const ROUNDING: f64 = 4.0;
/// Least velocity, as a share of the velocities of the step, at which the slope of a damper is evaluated. For n < 1 the slope at rest is
/// infinite, and Newton's method would stand still.
const LEAST_VELOCITY: f64 = 1e-6;
/// Largest number of turning points within one sampling interval. A mode sampled twice a cycle has one. If there are more, as under a force
/// that changes faster than it is sampled, the rest of the interval is taken in one step.
const MOST_TURNS: u32 = 16;
/// Largest number of rounds in the search for a turning point. The secant needs about eight; 60 halvings leave less than rounding.
const TURNING_ROUNDS: u32 = 60;

/// Time stepping of a mode with a joint and parts.
#[derive(Debug, Clone, Copy)]
pub struct WithParts<'a> {
    scheme: Newmark,
    oscillator: Oscillator,
    parts: &'a [Part],
    /// Sum of the sizes of dry friction of all parts.
    friction: f64,
    /// Whether steps are cut where the velocity vanishes. They are for dry friction, and for dampers with n < 1, whose force changes there
    /// almost as abruptly.
    cuts: bool,
}

/// The end of a run with parts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PartsEnd {
    /// Final velocity.
    pub velocity: f64,
    /// Energy balance of the run; `friction` is the loss to the joint and the parts, and `stored` includes the parts' springs.
    pub energy: EnergyBalance,
}

/// The moving state: displacement, velocity and joint force.
#[derive(Clone, Copy)]
struct At {
    q: f64,
    v: f64,
    joint: f64,
}

/// Result of one step: the increment of the displacement, and the velocity after the step.
#[derive(Clone, Copy)]
struct Stride {
    x: f64,
    v: f64,
}

/// A piece of the sampling interval: its scheme, the applied forces at its two ends, the direction of dry friction.
#[derive(Clone, Copy)]
struct Piece {
    scheme: Newmark,
    p: [f64; 2],
    direction: f64,
}

impl<'a> WithParts<'a> {
    /// Time stepping of `oscillator` with `parts` by `scheme`, which must be average acceleration, prewarped or not.
    ///
    /// # Errors
    /// [`Error::Unsupported`] for another scheme; [`Error::OutOfRange`] when the step is too long for a negative K_∞.
    pub fn new(scheme: &Newmark, oscillator: &Oscillator, parts: &'a [Part]) -> Result<Self, Error> {
        if !scheme.is_average_acceleration() {
            let what = "a mode with parts is stepped with beta = 0.25 and gamma = 0.5 only";
            return Err(Error::Unsupported { what });
        }
        scheme.checked_effective_stiffness(oscillator)?;
        let friction = sum_of_parts(parts, Part::friction);
        let steep = |part: &Part| matches!(part, Part::PowerDamping(damper) if damper.n() < 1.0);
        let cuts = friction > 0.0 || parts.iter().any(steep);
        Ok(Self { scheme: *scheme, oscillator: *oscillator, parts, friction, cuts })
    }

    /// Integrates over the samples from the initial `velocity` and the displacement in the joint's `state`; `force` is as in
    /// [`Newmark::integrate`]. The joint force in the output is that of joint and parts together.
    ///
    /// # Errors
    /// [`Error::Length`] when the buffers disagree.
    ///
    /// ```
    /// use iwan_core::{Coulomb, Newmark, NoJoint, Oscillator, Part, ResidualStiffness, Samples, WithParts};
    /// // Dry friction alone: half a cycle takes 2 F/k from the amplitude, exactly.
    /// let mode = Oscillator::new(1.0, 0.0, 0.0, ResidualStiffness::Positive)?;
    /// let k = mode.k_inf();
    /// let parts = [Part::from(Coulomb::new(0.01 * k)?)];
    /// let (mut q, mut v, mut a, mut f) = ([0.0; 51], [0.0; 51], [0.0; 51], [0.0; 51]);
    /// let mut out = Samples { displacement: &mut q, velocity: &mut v, acceleration: &mut a, joint_force: &mut f };
    /// let scheme = Newmark::prewarped(0.01, mode.omega0())?;
    /// let end = WithParts::new(&scheme, &mode, &parts)?.integrate(&NoJoint, &mut 1.0, 0.0, &[], &mut out)?;
    /// assert!((q[50] + 0.98).abs() < 1e-12);
    /// assert!((end.energy.friction / (0.01 * k * 1.98) - 1.0).abs() < 1e-12);
    /// # Ok::<(), iwan_core::Error>(())
    /// ```
    pub fn integrate<State, J: Trial<State>>(
        &self,
        joint: &J,
        state: &mut State,
        velocity: f64,
        force: &[f64],
        out: &mut Samples<'_>,
    ) -> Result<PartsEnd, Error> {
        let samples = out.checked_len()?;
        let mut at = At { q: joint.displacement(state), v: velocity, joint: joint.joint_force(state) };
        let stored = |q: f64| sum_of_parts(self.parts, |part| part.energy(q));
        let start = (Motion { displacement: at.q, velocity }, joint.stored_energy(state) + stored(at.q));
        let mut works = Works::default();
        let mut p = force_at(force, 0);
        self.write(&at, p, 0, out);
        for n in 1..samples {
            let next = force_at(force, n);
            self.interval(joint, state, &mut at, [p, next], &mut works);
            p = next;
            self.write(&at, p, n, out);
        }
        let end = Motion { displacement: at.q, velocity: at.v };
        let stored = JointEnergy { start: start.1, end: joint.stored_energy(state) + stored(at.q) };
        let energy = EnergyBalance::close(&self.oscillator, [start.0, end], stored, works);
        Ok(PartsEnd { velocity: at.v, energy })
    }

    /// The force on the mode at rest under the applied force `p`, without dry friction.
    fn drive(&self, at: &At, p: f64) -> f64 {
        p - self.oscillator.k_inf() * at.q
            - at.joint
            - sum_of_parts(self.parts, |part| part.elastic_force(at.q))
    }

    /// Writes sample `n`, where the applied force is `p`.
    fn write(&self, at: &At, p: f64, n: usize, out: &mut Samples<'_>) {
        let damping = sum_of_parts(self.parts, |part| part.damping_force(at.v));
        let drive = self.drive(at, p);
        let friction = match at.v {
            0.0 if drive.abs() <= self.friction => drive,
            0.0 => self.friction.copysign(drive),
            v => self.friction.copysign(v),
        };
        let elastic = sum_of_parts(self.parts, |part| part.elastic_force(at.q));
        let a = drive - self.oscillator.viscous() * at.v - damping - friction;
        out.set(n, [at.q, at.v, a, at.joint + elastic + damping + friction]);
    }

    /// Steps from one sample to the next, under an applied force that changes linearly from `p[0]` to `p[1]`.
    fn interval<State, J: Trial<State>>(
        &self,
        joint: &J,
        state: &mut State,
        at: &mut At,
        p: [f64; 2],
        works: &mut Works,
    ) {
        if !self.cuts {
            let piece = Piece { scheme: self.scheme, p, direction: 0.0 };
            let stride = self.stride(joint, state, at, &piece);
            return self.take(joint, state, at, &piece, stride, works);
        }
        let mut done = 0.0;
        for turns in 0.. {
            let now = p[0] + done * (p[1] - p[0]);
            let direction = if at.v == 0.0 {
                let drives = [self.drive(at, now), self.drive(at, p[1])];
                let Some((share, direction)) = self.departure(drives) else { return };
                done += share * (1.0 - done);
                direction
            } else {
                1.0_f64.copysign(at.v)
            };
            let from = p[0] + done * (p[1] - p[0]);
            let piece = |share: f64| Piece {
                scheme: self.scheme.shortened(self.oscillator.omega0(), share * (1.0 - done)),
                p: [from, from + share * (p[1] - from)],
                direction,
            };
            let whole = piece(1.0);
            let stride = self.stride(joint, state, at, &whole);
            if direction * stride.v >= 0.0 || turns == MOST_TURNS || stride.v.is_nan() {
                return self.take(joint, state, at, &whole, stride, works);
            }
            let velocity = |share: f64| direction * self.stride(joint, state, at, &piece(share)).v;
            let Some(share) = turning_share([direction * at.v, direction * stride.v], velocity) else {
                return;
            };
            let last = piece(share);
            let x = self.stride(joint, state, at, &last).x;
            self.take(joint, state, at, &last, Stride { x, v: 0.0 }, works);
            done += share * (1.0 - done);
            if done >= 1.0 {
                return;
            }
        }
    }

    /// The time at which a mode at rest departs, as a share of the rest of the interval, and the direction in which it departs; none if
    /// it stays at rest. The force on the mode changes linearly from `drives[0]` to `drives[1]`.
    fn departure(&self, [now, end]: [f64; 2]) -> Option<(f64, f64)> {
        if now.abs() > self.friction {
            return Some((0.0, 1.0_f64.copysign(now)));
        }
        if end.abs() <= self.friction {
            return None;
        }
        let direction = 1.0_f64.copysign(end);
        Some(((self.friction - direction * now) / (direction * (end - now)), direction))
    }

    /// Solves one step from `at`, without moving the joint's memory.
    fn stride<State, J: Trial<State>>(&self, joint: &J, state: &State, at: &At, piece: &Piece) -> Stride {
        let (h, k, c) = (piece.scheme.step(), self.oscillator.k_inf(), self.oscillator.viscous());
        let stiffness = 4.0 / (h * h) + 2.0 * c / h + k;
        let damping = |v: f64| sum_of_parts(self.parts, |part| part.damping_force(v));
        let applied = piece.scheme.force_scale() * (piece.p[0] + piece.p[1]);
        let held = 2.0 * (k * at.q + at.joint + piece.direction * self.friction);
        let known = applied + 4.0 * at.v / h - held;
        let scale = applied.abs() + (4.0 * at.v / h).abs() + 2.0 * (k * at.q).abs() + 2.0 * at.joint.abs();
        let noise = ROUNDING * f64::EPSILON * scale / stiffness;
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        // The start value is the end of the step without dampers, because at rest the slope of a damper may be infinite.
        let (mut x, mut before) = (known / stiffness, f64::INFINITY);
        for _ in 0..MOST_ROUNDS {
            let (u, v) = (at.q + x, x / h);
            let (force, tangent) = joint.trial(state, u);
            let (jumps, jumps_slope) = joint.mean_beyond_ends(state, u);
            let mean = sum_of_parts(self.parts, |part| part.mean_force(at.q, u)) + jumps;
            let residual = stiffness * x + (force - at.joint) + 2.0 * (mean + damping(v)) - known;
            if residual > 0.0 {
                high = x;
            } else {
                low = x;
            }
            let least = LEAST_VELOCITY * (at.v.abs() + v.abs()) + f64::MIN_POSITIVE;
            let damper = sum_of_parts(self.parts, |part| part.damping_slope(v.abs().max(least)));
            let spring = sum_of_parts(self.parts, |part| part.tangent(u));
            let steady = stiffness + tangent + spring + 2.0 / h * damper;
            // Just behind a break near the step's start the mean force falls steeply. At least half of the other slope is kept, so that the
            // slope stays positive.
            let slope = steady + if jumps == 0.0 { 0.0 } else { (2.0 * jumps_slope).max(-0.5 * steady) };
            let newton = x - residual / slope;
            let bracketed = low.is_finite() && high.is_finite();
            let outside = newton <= low || newton >= high || (newton - x).abs() > 0.5 * before;
            let next = if bracketed && outside { 0.5 * (low + high) } else { newton };
            if slope <= 0.0 && !bracketed || next.is_nan() {
                return Stride { x: f64::NAN, v: f64::NAN };
            }
            before = (next - x).abs();
            x = next;
            if before <= noise + f64::EPSILON * x.abs() {
                break;
            }
        }
        Stride { x, v: 2.0 * x / h - at.v }
    }

    /// Completes a step that was solved: moves the joint and adds the work of every force.
    fn take<State, J: Trial<State>>(
        &self,
        joint: &J,
        state: &mut State,
        at: &mut At,
        piece: &Piece,
        stride: Stride,
        works: &mut Works,
    ) {
        let Stride { x, v } = stride;
        let u = at.q + x;
        let way = u - at.q;
        let damping = |v: f64| sum_of_parts(self.parts, |part| part.damping_force(v));
        let mean = sum_of_parts(self.parts, |part| part.mean_force(at.q, u));
        let jumps = joint.mean_beyond_ends(state, u).0;
        let force = if x.is_nan() { f64::NAN } else { joint.advance(state, u) };
        works.force += 0.5 * piece.scheme.force_scale() * (piece.p[0] + piece.p[1]) * way;
        works.damper += 0.5 * self.oscillator.viscous() * (at.v + v) * way;
        let parts = mean + damping(way / piece.scheme.step()) + piece.direction * self.friction;
        works.joint += (0.5 * (at.joint + force) + jumps + parts) * way;
        *at = At { q: u, v, joint: force };
    }
}

/// The share of a step after which the velocity vanishes. Given are the velocities at both ends, the first >= 0 and the last < 0, and a
/// function for the velocity after any share. None if the motion does not leave rest at all.
fn turning_share([first, last]: [f64; 2], velocity: impl Fn(f64) -> f64) -> Option<f64> {
    let (mut low, mut high) = ([0.0, first], [1.0, last]);
    if first == 0.0 {
        let away = (1..TURNING_ROUNDS).map(|n| libm::ldexp(1.0, -n.cast_signed()));
        let away = away.map(|share| [share, velocity(share)]).find(|at| at[1] > 0.0);
        low = away?;
    }
    let rest = f64::EPSILON * (first - last);
    let mut side = 0.0;
    for _ in 0..TURNING_ROUNDS {
        let share = (low[0] * high[1] - high[0] * low[1]) / (high[1] - low[1]);
        let share = if share > low[0] && share < high[0] { share } else { 0.5 * (low[0] + high[0]) };
        let now = velocity(share);
        if now.abs() <= rest || high[0] - low[0] <= f64::EPSILON {
            return Some(share);
        }
        // The Illinois variant of regula falsi: the value at an end that stays twice in a row is halved.
        let stays = now * side > 0.0;
        if now > 0.0 {
            low = [share, now];
            high[1] *= if stays { 0.5 } else { 1.0 };
        } else {
            high = [share, now];
            low[1] *= if stays { 0.5 } else { 1.0 };
        }
        side = now;
    }
    Some(0.5 * (low[0] + high[0]))
}
