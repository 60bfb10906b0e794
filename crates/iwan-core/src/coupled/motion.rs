//! The motion of coupled modes.

use super::joints::JointsInMotion;
use super::lanes::{LANES, Lanes, dot, groups};
use super::modes::CoupledModes;
use crate::error::{Error, check_length};

/// Displacements and velocities of coupled modes, and the forces N of their joints.
#[derive(Debug, Clone)]
pub struct CoupledMotion<S> {
    pub(super) q: S,
    pub(super) v: S,
    /// v̄* of the present step: the mean velocity with N held constant.
    pub(super) mean: S,
    /// Σ b N of each mode.
    pub(super) held: S,
    /// N of each joint.
    pub(super) missing: S,
    /// Δs* and ΔN of each joint.
    pub(super) ahead: S,
    pub(super) change: S,
}

impl<S: AsRef<[Lanes]> + AsMut<[Lanes]>> CoupledMotion<S> {
    /// Modes at `displacement` with `velocity` under the load `force`, to which virgin joints are loaded statically.
    ///
    /// # Errors
    /// [`Error::Length`] for rows that do not fit and too little room; as [`JointsInMotion::settle`].
    pub fn new(
        modes: &CoupledModes<S>,
        joints: &mut impl JointsInMotion,
        [displacement, velocity]: [&[f64]; 2],
        force: f64,
        storage: impl Fn(usize) -> S,
    ) -> Result<Self, Error> {
        check_length("displacement", displacement.len(), modes.modes())?;
        check_length("velocity", velocity.len(), modes.modes())?;
        check_length("joints", joints.count(), modes.joints())?;
        let room = |values: &[f64], count: usize| -> Result<S, Error> {
            let (needed, mut room) = (groups(count), storage(groups(count)));
            let found = room.as_ref().len();
            if found < needed {
                return Err(Error::Length { name: "storage", needed, found });
            }
            let flat = room.as_mut().as_flattened_mut();
            flat.fill(0.0);
            flat[..values.len()].copy_from_slice(values);
            Ok(room)
        };
        let (n, j) = (modes.modes(), modes.joints());
        let mut motion = Self {
            q: room(displacement, n)?,
            v: room(velocity, n)?,
            mean: room(&[], n)?,
            held: room(&[], n)?,
            missing: room(&[], j)?,
            ahead: room(&[], j)?,
            change: room(&[], j)?,
        };
        let width = groups(n);
        for i in 0..j {
            let shape = &modes.participation.as_ref()[i * width..(i + 1) * width];
            let way = dot(shape, &motion.q.as_ref()[..width]) + modes.slip_at_force()[i] * force;
            motion.ahead.as_mut().as_flattened_mut()[i] = way;
        }
        joints.settle(modes, &motion.ahead.as_ref().as_flattened()[..j])?;
        motion.read_joints(modes, joints);
        Ok(motion)
    }

    /// N of each joint and Σ b N of each mode.
    #[inline]
    pub(super) fn read_joints(&mut self, modes: &CoupledModes<S>, joints: &impl JointsInMotion) {
        let (width, k) = (groups(modes.modes()), modes.joint_stiffness());
        let held = &mut self.held.as_mut()[..width];
        held.as_flattened_mut().fill(0.0);
        for (i, k) in k.iter().enumerate() {
            let n = joints.force(i) - k * joints.slip(i);
            self.missing.as_mut().as_flattened_mut()[i] = n;
            let shape = &modes.participation.as_ref()[i * width..(i + 1) * width];
            for (held, b) in held.iter_mut().zip(shape) {
                for l in 0..LANES {
                    held[l] += b[l] * n;
                }
            }
        }
    }

    /// Displacement of mode `index`.
    #[must_use]
    pub fn displacement(&self, index: usize) -> f64 {
        self.q.as_ref().as_flattened()[index]
    }

    /// Velocity of mode `index`.
    #[must_use]
    pub fn velocity(&self, index: usize) -> f64 {
        self.v.as_ref().as_flattened()[index]
    }
}
