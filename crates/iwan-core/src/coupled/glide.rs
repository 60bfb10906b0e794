//! Up to four modes with one joint on sliders, without Newton's method.
//!
//! On a straight piece of slope k the step Δs = Δs* - c ΔN with ΔN = (k - K) Δs is one product, Δs = Δs*/(1 + c (k - K)),
//! and all constants of the modes stay in registers. Where a slider breaks loose or the motion turns round, the general
//! step takes over.

use super::joints::OneJoint;
use super::lanes::{LANES, Lanes, groups};
use super::modes::CoupledModes;
use super::motion::CoupledMotion;
use super::stepper::CoupledRows;
use crate::error::Error;
use crate::memory::{Hysteresis, Run, Runs, Segment, Sliders};
use crate::step::force_at;

/// The constants of one group of modes, as in [`CoupledModes`].
struct Constants {
    step: Lanes,
    push: Lanes,
    give: Lanes,
    drag: Lanes,
    stiffness: Lanes,
    viscous: Lanes,
    load: Lanes,
    drive: Lanes,
    shape: Lanes,
    reach: Lanes,
    slip_at_force: f64,
    /// K and c of the joint.
    joint: f64,
    coupling: f64,
}

/// What one step hands to the next.
#[derive(Clone, Copy)]
struct Motion {
    q: Lanes,
    v: Lanes,
    mean: Lanes,
    /// N, and Δs* of the step that comes.
    missing: f64,
    ahead: f64,
}

/// A straight piece, in x = s - anchor.
struct Piece {
    anchor: f64,
    reach: f64,
    base: f64,
    stiffness: f64,
    /// N at x = 0, and its slope k - K.
    held: f64,
    slope: f64,
    /// 1/(1 + c (k - K)).
    gain: f64,
}

impl Constants {
    fn piece(&self, segment: &Segment) -> Piece {
        let slope = segment.stiffness - self.joint;
        Piece {
            anchor: segment.anchor,
            reach: segment.reach,
            base: segment.base,
            stiffness: segment.stiffness,
            held: segment.base - self.joint * segment.anchor,
            slope,
            gain: 1.0 / (1.0 + self.coupling * slope),
        }
    }

    /// Ends a step with N and ΔN, writes it at the load `p`, and begins the next one at the load `next`.
    #[inline]
    fn sweep(&self, m: &mut Motion, change: f64, [p, next]: [f64; 2]) -> Lanes {
        let (mean, jump) = (0.5 * (p + next), next - p);
        let (mut acceleration, mut way) = ([0.0; LANES], [0.0; LANES]);
        for l in 0..LANES {
            let rate = m.mean[l] - self.give[l] * (self.shape[l] * change);
            m.q[l] += self.step[l] * rate;
            m.v[l] = 2.0 * rate - m.v[l];
            let pull = self.stiffness[l] * m.q[l] + self.shape[l] * m.missing;
            acceleration[l] = self.load[l] * p - self.viscous[l] * m.v[l] - pull;
            m.mean[l] = m.v[l] + (self.push[l] * (self.drive[l] * mean - pull) - self.drag[l] * m.v[l]);
            way[l] = self.reach[l] * m.mean[l];
        }
        m.ahead = ((way[0] + way[2]) + (way[1] + way[3])) + self.slip_at_force * jump;
        acceleration
    }
}

impl<S: AsRef<[Lanes]> + AsMut<[Lanes]>> CoupledModes<S> {
    /// As [`integrate`](Self::integrate) for one joint on a population of sliders, several times faster with up to four
    /// modes; more modes or joints take the general path.
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
        // The first sample, and the first step's prediction, are the general path's.
        let mut first = CoupledRows {
            displacement: &mut out.displacement[..1],
            velocity: &mut out.velocity[..1],
            acceleration: &mut out.acceleration[..1],
            slip: &mut out.slip[..1],
            joint_force: &mut out.joint_force[..1],
        };
        self.integrate(motion, &mut OneJoint::new(sliders, state), force, &mut first)?;
        let c = self.constants();
        let lanes = |row: &S| row.as_ref()[0];
        let mut m = Motion {
            q: lanes(&motion.q),
            v: lanes(&motion.v),
            mean: lanes(&motion.mean),
            missing: motion.missing.as_ref()[0][0],
            ahead: motion.ahead.as_ref()[0][0],
        };
        glide(&c, &mut m, (sliders, state), force, (samples, out));
        (motion.q.as_mut()[0], motion.v.as_mut()[0], motion.mean.as_mut()[0]) = (m.q, m.v, m.mean);
        motion.ahead.as_mut()[0][0] = m.ahead;
        motion.read_joints(self, &OneJoint::new(sliders, state));
        Ok(())
    }

    fn constants(&self) -> Constants {
        let lanes = |row: &S| row.as_ref()[0];
        Constants {
            step: lanes(&self.step),
            push: lanes(&self.push),
            give: lanes(&self.give),
            drag: lanes(&self.drag),
            stiffness: lanes(&self.stiffness),
            viscous: lanes(&self.viscous),
            load: lanes(&self.load),
            drive: lanes(&self.drive),
            shape: lanes(&self.participation),
            reach: lanes(&self.reach),
            slip_at_force: self.slip_at_force()[0],
            joint: self.joint_stiffness()[0],
            coupling: self.coupling()[0],
        }
    }
}

/// Steps from the second sample on.
fn glide<R: AsRef<[Run]> + AsMut<[Run]>>(
    c: &Constants,
    m: &mut Motion,
    (sliders, state): (&Sliders<'_>, &mut Runs<R>),
    force: &[f64],
    (samples, out): (usize, &mut CoupledRows<'_>),
) {
    let inverse = 1.0 / c.coupling;
    let (q, v, a) =
        (&mut out.displacement[..samples], &mut out.velocity[..samples], &mut out.acceleration[..samples]);
    let (slip, joint_force) = (&mut out.slip[..samples], &mut out.joint_force[..samples]);
    let mut piece = c.piece(&state.segment(sliders.table()));
    let (mut direction, mut x) = (state.direction(), state.displacement() - piece.anchor);
    let mut at = *m;
    for n in 1..samples {
        let way = piece.gain * at.ahead;
        let to = x + way;
        let change = if direction * way >= 0.0 && direction * to <= piece.reach {
            x = to;
            piece.slope * way
        } else {
            state.rest_at(piece.anchor + x);
            let before = piece.base + piece.stiffness * x;
            let way = sliders.solve(state, inverse - c.joint, inverse * at.ahead);
            piece = c.piece(&state.segment(sliders.table()));
            (direction, x) = (state.direction(), state.displacement() - piece.anchor);
            (piece.base + piece.stiffness * x - before) - c.joint * way
        };
        at.missing = piece.held + piece.slope * x;
        a[n] = c.sweep(&mut at, change, [force_at(force, n), force_at(force, n + 1)]);
        (q[n], v[n]) = (at.q, at.v);
        (slip[n], joint_force[n]) = (piece.anchor + x, piece.base + piece.stiffness * x);
    }
    state.rest_at(piece.anchor + x);
    *m = at;
}
