//! Fast time steps of up to four modes with one joint: all constants and the motion of the modes stay in registers.
//!
//! On sliders no Newton iteration is needed. On a straight piece of slope k the step Δs = Δs* - c ΔN with ΔN = (k - K) Δs is one product,
//! Δs = Δs*/(1 + c (k - K)). Where a slider breaks loose or the motion turns round, the population's memory says on which piece the step ends.
//! Behind the load nothing is multiplied by its zeros: most samples of a ring-down lie there.

use core::ops::Range;

use super::joints::{JointsInMotion, OneJoint};
use super::lanes::{LANES, Lanes, dot, groups};
use super::modes::CoupledModes;
use super::motion::CoupledMotion;
use super::stepper::CoupledRows;
use crate::error::Error;
use crate::memory::{Run, Runs, Segment, Sliders};
use crate::step::force_at;

/// The constants of one group of modes, as in [`CoupledModes`].
struct Constants {
    step: Lanes,
    push: Lanes,
    drag: Lanes,
    stiffness: Lanes,
    viscous: Lanes,
    load: Lanes,
    /// What a unit mean load adds to the mean velocity of a step, and what a unit of it takes off the next one's.
    driven: Lanes,
    slowing: Lanes,
    shape: Lanes,
    reach: Lanes,
    /// Reductions of q, v, v̄* and Δs* by a unit of ΔN. Only `on_ahead` makes a step wait for the one before.
    on_q: Lanes,
    on_v: Lanes,
    on_mean: Lanes,
    on_ahead: f64,
    slip_at_force: f64,
    /// Initial stiffness K and coupling c of the joint.
    joint: f64,
    coupling: f64,
}

/// The state passed from one step to the next.
#[derive(Clone, Copy)]
struct Motion {
    q: Lanes,
    v: Lanes,
    mean: Lanes,
    /// N at the present sample, the restoring force ω² q + b N of each mode, and Δs* of the next step.
    missing: f64,
    restoring: Lanes,
    ahead: f64,
}

/// A straight piece of the joint's law, as a function of x = s - anchor.
#[derive(Clone, Copy)]
struct Piece {
    anchor: f64,
    reach: f64,
    base: f64,
    stiffness: f64,
    /// N at x = 0, and the slope k - K of N.
    held: f64,
    slope: f64,
    /// 1/(1 + c (k - K)), and (k - K) times that factor.
    gain: f64,
    yielding: f64,
}

impl Piece {
    /// Joint force.
    #[inline]
    fn force(&self, x: f64) -> f64 {
        self.base + self.stiffness * x
    }
}

impl Motion {
    fn of<S: AsRef<[Lanes]> + AsMut<[Lanes]>>(motion: &CoupledMotion<S>, c: &Constants) -> Self {
        let lanes = |row: &S| row.as_ref()[0];
        let missing = motion.missing.as_ref()[0][0];
        let q = lanes(&motion.q);
        Self {
            q,
            v: lanes(&motion.v),
            mean: lanes(&motion.mean),
            missing,
            restoring: core::array::from_fn(|l| c.stiffness[l] * q[l] + c.shape[l] * missing),
            ahead: motion.ahead.as_ref()[0][0],
        }
    }

    fn hand_back<S: AsRef<[Lanes]> + AsMut<[Lanes]>>(&self, motion: &mut CoupledMotion<S>) {
        (motion.q.as_mut()[0], motion.v.as_mut()[0], motion.mean.as_mut()[0]) = (self.q, self.v, self.mean);
        motion.ahead.as_mut()[0][0] = self.ahead;
    }
}

impl Constants {
    fn piece(&self, segment: &Segment) -> Piece {
        let slope = segment.stiffness - self.joint;
        let gain = 1.0 / (1.0 + self.coupling * slope);
        Piece {
            anchor: segment.anchor,
            reach: segment.reach,
            base: segment.base,
            stiffness: segment.stiffness,
            held: segment.base - self.joint * segment.anchor,
            slope,
            gain,
            yielding: slope * gain,
        }
    }

    /// The piece after the next slider of the run has broken loose; none where the run ends with that slider.
    #[inline]
    fn behind<R: AsRef<[Run]> + AsMut<[Run]>>(
        &self,
        state: &Runs<R>,
        sliders: &Sliders<'_>,
    ) -> Option<Piece> {
        state.segment_after(sliders.table(), 1).map(|segment| self.piece(&segment))
    }

    /// Where a step ends on the `next` piece, which follows after one slider; none where it ends beyond it.
    #[inline]
    fn landing(
        &self,
        piece: &Piece,
        next: Piece,
        x: f64,
        ahead: f64,
        direction: f64,
    ) -> Option<(Piece, f64)> {
        // At the beginning of the step the next piece's line lies above the force.
        let above = (next.base - piece.base) + (next.stiffness - piece.stiffness) * x;
        let to = x + next.gain * (ahead - self.coupling * above);
        (direction * to <= next.reach).then_some((next, to))
    }

    /// Completes the step to a sample with the load `p` as if N stayed constant, and begins the next step, at whose end the load is `next`. `FREE`
    /// where both loads are zero.
    #[inline]
    fn held<const FREE: bool>(&self, m: &Motion, [p, next]: [f64; 2]) -> Motion {
        let (mean, jump) = (0.5 * (p + next), next - p);
        let (mut to, mut way) = (*m, [0.0; LANES]);
        for (l, way) in way.iter_mut().enumerate() {
            to.q[l] = m.q[l] + self.step[l] * m.mean[l];
            to.v[l] = 2.0 * m.mean[l] - m.v[l];
            // Of the force at the end of the step only the last product waits for the mean velocity of the step before.
            let known = self.push[l] * m.restoring[l] - self.drag[l] * m.v[l];
            let known = if FREE { known } else { known - self.driven[l] * mean };
            to.mean[l] = to.v[l] - (known + self.slowing[l] * m.mean[l]);
            *way = self.reach[l] * to.mean[l];
        }
        to.ahead = (way[0] + way[2]) + (way[1] + way[3]);
        if !FREE {
            to.ahead += self.slip_at_force * jump;
        }
        to
    }

    /// Corrects that step for the change ΔN, and returns the accelerations under the load `p`, which is zero where
    /// the motion is `FREE`.
    #[inline]
    fn changed<const FREE: bool>(&self, m: &mut Motion, change: f64, p: f64) -> Lanes {
        let mut acceleration = [0.0; LANES];
        for (l, acceleration) in acceleration.iter_mut().enumerate() {
            m.q[l] -= self.on_q[l] * change;
            m.v[l] -= self.on_v[l] * change;
            m.mean[l] -= self.on_mean[l] * change;
            m.restoring[l] = self.stiffness[l] * m.q[l] + self.shape[l] * m.missing;
            let held_back = self.viscous[l] * m.v[l] + m.restoring[l];
            *acceleration = if FREE { -held_back } else { self.load[l] * p - held_back };
        }
        m.ahead -= self.on_ahead * change;
        acceleration
    }
}

impl<S: AsRef<[Lanes]> + AsMut<[Lanes]>> CoupledModes<S> {
    /// Does what [`integrate`](Self::integrate) does for one joint on a population of sliders, several times faster with up to four modes.
    /// More modes or more joints take the general path.
    ///
    /// # Errors
    /// As [`integrate`](Self::integrate).
    pub fn integrate_sliders<R: AsRef<[Run]> + AsMut<[Run]>>(
        &self,
        motion: &mut CoupledMotion<S>,
        sliders: &Sliders<'_>,
        state: &mut Runs<R>,
        force: &[f64],
        out: &mut CoupledRows<'_>,
    ) -> Result<(), Error> {
        if self.joints() != 1 || groups(self.modes()) != 1 {
            return self.integrate(motion, &mut OneJoint::new(sliders, state), force, out);
        }
        let samples = out.checked_len(self)?;
        self.begin(motion, &OneJoint::new(sliders, state), force, out);
        let c = self.constants();
        let mut m = Motion::of(motion, &c);
        glide(&c, &mut m, (sliders, state), force, (samples, out));
        m.hand_back(motion);
        motion.read_joints(self, &OneJoint::new(sliders, state));
        Ok(())
    }

    /// [`integrate`](Self::integrate) for one joint and up to four modes, from the second sample on.
    #[inline]
    pub(super) fn narrow(
        &self,
        motion: &mut CoupledMotion<S>,
        joint: &mut impl JointsInMotion,
        force: &[f64],
        (samples, out): (usize, &mut CoupledRows<'_>),
    ) -> Result<(), Error> {
        let (q, v, a) = (
            &mut out.displacement[..samples],
            &mut out.velocity[..samples],
            &mut out.acceleration[..samples],
        );
        let (slip, joint_force) = (&mut out.slip[..samples], &mut out.joint_force[..samples]);
        let c = self.constants();
        let mut m = Motion::of(motion, &c);
        for n in 1..samples {
            let (mut change, p) = ([0.0], force_at(force, n));
            let mut to = c.held::<false>(&m, [p, force_at(force, n + 1)]);
            joint.solve(self, &[m.ahead], &mut change)?;
            (slip[n], joint_force[n]) = (joint.slip(0), joint.force(0));
            to.missing = joint_force[n] - c.joint * slip[n];
            a[n] = c.changed::<false>(&mut to, change[0], p);
            m = to;
            (q[n], v[n]) = (m.q, m.v);
        }
        m.hand_back(motion);
        motion.read_joints(self, joint);
        Ok(())
    }

    fn constants(&self) -> Constants {
        let lanes = |row: &S| row.as_ref()[0];
        let (step, push, give, drag) =
            (lanes(&self.step), lanes(&self.push), lanes(&self.give), lanes(&self.drag));
        let (stiffness, shape, reach) =
            (lanes(&self.stiffness), lanes(&self.participation), lanes(&self.reach));
        let of_rate: Lanes = core::array::from_fn(|l| give[l] * shape[l]);
        let on_q: Lanes = core::array::from_fn(|l| step[l] * of_rate[l]);
        let on_mean: Lanes = core::array::from_fn(|l| {
            2.0 * of_rate[l] + (push[l] * (shape[l] - stiffness[l] * on_q[l]) - 2.0 * drag[l] * of_rate[l])
        });
        Constants {
            step,
            push,
            drag,
            stiffness,
            viscous: lanes(&self.viscous),
            load: lanes(&self.load),
            driven: core::array::from_fn(|l| push[l] * lanes(&self.drive)[l]),
            slowing: core::array::from_fn(|l| push[l] * (stiffness[l] * step[l]) + 2.0 * drag[l]),
            shape,
            reach,
            on_q,
            on_v: of_rate.map(|rate| 2.0 * rate),
            on_mean,
            on_ahead: dot(&[reach], &[on_mean]),
            slip_at_force: self.slip_at_force()[0],
            joint: self.joint_stiffness()[0],
            coupling: self.coupling()[0],
        }
    }
}

/// The joint's population in motion: where it stands on its straight piece, and which way it goes.
struct Standing<'a, 'b, R> {
    sliders: &'a Sliders<'b>,
    state: &'a mut Runs<R>,
    piece: Piece,
    direction: f64,
    x: f64,
}

/// Computes the samples from the second on, with the joint on sliders.
fn glide<R: AsRef<[Run]> + AsMut<[Run]>>(
    c: &Constants,
    m: &mut Motion,
    (sliders, state): (&Sliders<'_>, &mut Runs<R>),
    force: &[f64],
    (samples, out): (usize, &mut CoupledRows<'_>),
) {
    let piece = c.piece(&state.segment(sliders.table()));
    let (direction, x) = (state.direction(), state.displacement() - piece.anchor);
    let mut joint = Standing { sliders, state, piece, direction, x };
    let loaded = force.iter().rposition(|p| *p != 0.0).map_or(0, |last| last + 1);
    let struck = loaded.clamp(1, samples);
    steps::<false, R>(c, m, &mut joint, force, (1..struck, out));
    steps::<true, R>(c, m, &mut joint, force, (struck..samples, out));
    joint.state.rest_at(joint.piece.anchor + joint.x);
}

/// Samples in a range; `FREE` where no load acts any more.
fn steps<const FREE: bool, R: AsRef<[Run]> + AsMut<[Run]>>(
    c: &Constants,
    m: &mut Motion,
    joint: &mut Standing<'_, '_, R>,
    force: &[f64],
    (range, out): (Range<usize>, &mut CoupledRows<'_>),
) {
    let inverse = 1.0 / c.coupling;
    let from = range.start;
    let (q, v, a) = (
        &mut out.displacement[range.clone()],
        &mut out.velocity[range.clone()],
        &mut out.acceleration[range.clone()],
    );
    let (slip, joint_force) = (&mut out.slip[range.clone()], &mut out.joint_force[range.clone()]);
    let Standing { sliders, state, piece, direction, x } = joint;
    let mut at = *m;
    // The piece behind the next slider that breaks loose is computed in advance: most pieces end with one.
    let mut behind = c.behind(state, sliders);
    for n in 0..q.len() {
        let load = |n: usize| if FREE { 0.0 } else { force_at(force, from + n) };
        let p = load(n);
        let mut to_come = c.held::<FREE>(&at, [p, load(n + 1)]);
        let way = piece.gain * at.ahead;
        let to = *x + way;
        let onward = *direction * way >= 0.0;
        let change = if onward && *direction * to <= piece.reach {
            *x = to;
            piece.yielding * at.ahead
        } else if let Some((next, to)) =
            behind.filter(|_| onward).and_then(|next| c.landing(piece, next, *x, at.ahead, *direction))
        {
            let change = (next.force(to) - piece.force(*x)) - c.joint * (to - *x);
            state.pass(1);
            (*piece, *x) = (next, to);
            behind = c.behind(state, sliders);
            change
        } else {
            state.rest_at(piece.anchor + *x);
            let before = piece.force(*x);
            let load = inverse * at.ahead;
            let force = state.aim(sliders.table(), inverse - c.joint, load);
            let segment = state.segment(sliders.table());
            *piece = c.piece(&segment);
            let way = c.coupling * piece.gain * (load - segment.gap(state.displacement(), force));
            (*direction, *x) = (state.direction(), state.displacement() + way - piece.anchor);
            behind = c.behind(state, sliders);
            (piece.force(*x) - before) - c.joint * way
        };
        to_come.missing = piece.held + piece.slope * *x;
        a[n] = c.changed::<FREE>(&mut to_come, change, p);
        at = to_come;
        (q[n], v[n]) = (at.q, at.v);
        (slip[n], joint_force[n]) = (piece.anchor + *x, piece.force(*x));
    }
    *m = at;
}
