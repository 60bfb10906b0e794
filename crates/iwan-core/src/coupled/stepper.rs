//! Time steps of coupled modes with any joints.

use super::joints::JointsInMotion;
use super::lanes::{LANES, Lanes, dot, groups};
use super::modes::CoupledModes;
use super::motion::CoupledMotion;
use crate::error::{Error, check_length};
use crate::step::force_at;

/// Output of coupled modes. For each sample, the initial state first, a slice holds one row: the [`groups`] of modes, or one number per
/// joint.
#[derive(Debug)]
pub struct CoupledRows<'a> {
    /// Displacements q.
    pub displacement: &'a mut [Lanes],
    /// Velocities q'.
    pub velocity: &'a mut [Lanes],
    /// Accelerations q''.
    pub acceleration: &'a mut [Lanes],
    /// Slips s.
    pub slip: &'a mut [f64],
    /// Joint forces F.
    pub joint_force: &'a mut [f64],
}

impl CoupledRows<'_> {
    /// Number of samples; all slices must agree and hold at least one.
    pub(super) fn checked_len<S: AsRef<[Lanes]> + AsMut<[Lanes]>>(
        &self,
        modes: &CoupledModes<S>,
    ) -> Result<usize, Error> {
        let (width, joints) = (groups(modes.modes()), modes.joints());
        let samples = self.slip.len() / joints;
        check_length("slip", self.slip.len(), samples.max(1) * joints)?;
        check_length("joint_force", self.joint_force.len(), samples * joints)?;
        check_length("displacement", self.displacement.len(), samples * width)?;
        check_length("velocity", self.velocity.len(), samples * width)?;
        check_length("acceleration", self.acceleration.len(), samples * width)?;
        Ok(samples)
    }
}

impl<S: AsRef<[Lanes]> + AsMut<[Lanes]>> CoupledModes<S> {
    /// Steps from `motion`, which is the first sample, under the load `force`, which has one value per sample and is zero after its end.
    ///
    /// # Errors
    /// [`Error::Length`] when the rows disagree; errors of [`JointsInMotion::solve`].
    ///
    /// ```
    /// use iwan_core::{
    ///     Continuum, CoupledJoint, CoupledMode, CoupledModes, CoupledMotion, CoupledRows, Jenkins, Newmark, OneJoint,
    ///     Oscillator, ResidualStiffness, Reversal,
    /// };
    /// // One mode of 1 Hz, stuck for good, released at q = 1: a cosine.
    /// let oscillator = Oscillator::new(1.0, 0.0, 0.0, ResidualStiffness::Positive)?;
    /// let scheme = Newmark::prewarped(0.01, oscillator.omega0())?;
    /// let joint = CoupledJoint { stiffness: 3.0, participation: &[1.0], compliance: &[0.0], slip_at_force: 0.0 };
    /// let storage = |_| [[0.0; 4]; 1];
    /// let modes = CoupledModes::new(&[CoupledMode { oscillator, scheme, shape_at_force: 1.0 }], &[joint], storage)?;
    /// let law = Continuum::new(Jenkins::new(3.0, 99.0)?);
    /// let mut state = law.virgin([Reversal::default(); 8])?;
    /// let mut joints = OneJoint::new(&law, &mut state);
    /// let mut motion = CoupledMotion::new(&modes, &mut joints, [&[1.0], &[0.0]], 0.0, storage)?;
    /// let (mut q, mut v, mut a) = ([[0.0; 4]; 26], [[0.0; 4]; 26], [[0.0; 4]; 26]);
    /// let (mut slip, mut joint_force) = ([0.0; 26], [0.0; 26]);
    /// let mut out = CoupledRows {
    ///     displacement: &mut q,
    ///     velocity: &mut v,
    ///     acceleration: &mut a,
    ///     slip: &mut slip,
    ///     joint_force: &mut joint_force,
    /// };
    /// modes.integrate(&mut motion, &mut joints, &[], &mut out)?;
    /// assert!(q[25][0].abs() < 1e-12 && (v[25][0] + oscillator.omega0()).abs() < 1e-10);
    /// assert!((joint_force[10] - 3.0 * slip[10]).abs() < 1e-13);
    /// # Ok::<(), iwan_core::Error>(())
    /// ```
    pub fn integrate(
        &self,
        motion: &mut CoupledMotion<S>,
        joints: &mut impl JointsInMotion,
        force: &[f64],
        out: &mut CoupledRows<'_>,
    ) -> Result<(), Error> {
        let samples = out.checked_len(self)?;
        check_length("joints", joints.count(), self.joints())?;
        self.begin(motion, joints, force, out);
        if self.joints() == 1 && groups(self.modes()) == 1 {
            return self.narrow(motion, joints, force, (samples, out));
        }
        for n in 1..samples {
            let j = self.joints();
            let ahead = &motion.ahead.as_ref().as_flattened()[..j];
            let change = &mut motion.change.as_mut().as_flattened_mut()[..j];
            joints.solve(self, ahead, change)?;
            self.complete(motion);
            motion.read_joints(self, joints);
            self.write(motion, joints, force_at(force, n), (n, out));
            self.predict(motion, force, n);
        }
        Ok(())
    }

    /// Writes the first sample and begins the first step.
    pub(super) fn begin(
        &self,
        motion: &mut CoupledMotion<S>,
        joints: &impl JointsInMotion,
        force: &[f64],
        out: &mut CoupledRows<'_>,
    ) {
        self.write(motion, joints, force_at(force, 0), (0, out));
        self.predict(motion, force, 0);
    }

    /// Begins the step from sample `n`: computes v̄* with N held constant, and Δs*.
    #[inline]
    fn predict(&self, motion: &mut CoupledMotion<S>, force: &[f64], n: usize) {
        let (p, next) = (force_at(force, n), force_at(force, n + 1));
        let mean = 0.5 * (p + next);
        let width = groups(self.modes());
        for g in 0..width {
            let (push, drag, drive) = (self.push.as_ref()[g], self.drag.as_ref()[g], self.drive.as_ref()[g]);
            let (stiffness, q, v) = (self.stiffness.as_ref()[g], motion.q.as_ref()[g], motion.v.as_ref()[g]);
            let held = motion.held.as_ref()[g];
            let rate = &mut motion.mean.as_mut()[g];
            for l in 0..LANES {
                let pull = stiffness[l] * q[l] + held[l];
                rate[l] = v[l] + (push[l] * (drive[l] * mean - pull) - drag[l] * v[l]);
            }
        }
        let (a, jump) = (self.slip_at_force(), next - p);
        for (i, a) in a.iter().enumerate() {
            let reach = &self.reach.as_ref()[i * width..(i + 1) * width];
            let way = dot(reach, &motion.mean.as_ref()[..width]) + a * jump;
            motion.ahead.as_mut().as_flattened_mut()[i] = way;
        }
    }

    /// Completes the step with the changes ΔN.
    #[inline]
    fn complete(&self, motion: &mut CoupledMotion<S>) {
        let width = groups(self.modes());
        for g in 0..width {
            let (give, step) = (self.give.as_ref()[g], self.step.as_ref()[g]);
            let mut sum = [0.0; LANES];
            let changes = &motion.change.as_ref().as_flattened()[..self.joints()];
            for (i, change) in changes.iter().enumerate() {
                let b = self.participation.as_ref()[i * width + g];
                for l in 0..LANES {
                    sum[l] += b[l] * change;
                }
            }
            let mean = motion.mean.as_ref()[g];
            let (q, v) = (&mut motion.q.as_mut()[g], &mut motion.v.as_mut()[g]);
            for l in 0..LANES {
                let rate = mean[l] - give[l] * sum[l];
                q[l] += step[l] * rate;
                v[l] = 2.0 * rate - v[l];
            }
        }
    }

    /// Writes sample `n`, at which the load is `p`.
    #[inline]
    fn write(
        &self,
        motion: &CoupledMotion<S>,
        joints: &impl JointsInMotion,
        p: f64,
        (n, out): (usize, &mut CoupledRows<'_>),
    ) {
        let (width, j) = (groups(self.modes()), self.joints());
        for g in 0..width {
            let (q, v, held) = (motion.q.as_ref()[g], motion.v.as_ref()[g], motion.held.as_ref()[g]);
            let (load, viscous, stiffness) =
                (self.load.as_ref()[g], self.viscous.as_ref()[g], self.stiffness.as_ref()[g]);
            let at = n * width + g;
            (out.displacement[at], out.velocity[at]) = (q, v);
            for l in 0..LANES {
                out.acceleration[at][l] = load[l] * p - viscous[l] * v[l] - (stiffness[l] * q[l] + held[l]);
            }
        }
        for i in 0..j {
            (out.slip[n * j + i], out.joint_force[n * j + i]) = (joints.slip(i), joints.force(i));
        }
    }
}
