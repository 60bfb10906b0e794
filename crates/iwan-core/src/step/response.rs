//! Buffers of a response in the caller's memory, with one sample per time step.

use crate::error::{Error, check_length};

/// Output of a time integration. All slices have one entry per sample, the initial state first.
#[derive(Debug)]
pub struct Samples<'a> {
    /// Displacement q.
    pub displacement: &'a mut [f64],
    /// Velocity q'.
    pub velocity: &'a mut [f64],
    /// Acceleration q''.
    pub acceleration: &'a mut [f64],
    /// Joint force F_J.
    pub joint_force: &'a mut [f64],
}

impl Samples<'_> {
    /// Number of samples; all four slices must agree and hold at least one.
    ///
    /// # Errors
    /// [`Error::Length`] with the name of the slice.
    pub fn checked_len(&self) -> Result<usize, Error> {
        let needed = self.displacement.len();
        if needed == 0 {
            return Err(Error::Length { name: "displacement", needed: 1, found: 0 });
        }
        check_length("velocity", self.velocity.len(), needed)?;
        check_length("acceleration", self.acceleration.len(), needed)?;
        check_length("joint_force", self.joint_force.len(), needed)?;
        Ok(needed)
    }

    /// The samples `first` to `last`, both included, as buffers of their own.
    ///
    /// # Panics
    /// If `last` is not a sample.
    pub fn between(&mut self, first: usize, last: usize) -> Samples<'_> {
        Samples {
            displacement: &mut self.displacement[first..=last],
            velocity: &mut self.velocity[first..=last],
            acceleration: &mut self.acceleration[first..=last],
            joint_force: &mut self.joint_force[first..=last],
        }
    }

    /// The samples from `first` on.
    pub(crate) fn tail(&mut self, first: usize) -> Samples<'_> {
        Samples {
            displacement: &mut self.displacement[first..],
            velocity: &mut self.velocity[first..],
            acceleration: &mut self.acceleration[first..],
            joint_force: &mut self.joint_force[first..],
        }
    }

    /// The first `count` samples.
    pub(crate) fn first(self, count: usize) -> Self {
        Self {
            displacement: &mut self.displacement[..count],
            velocity: &mut self.velocity[..count],
            acceleration: &mut self.acceleration[..count],
            joint_force: &mut self.joint_force[..count],
        }
    }

    #[inline]
    pub(crate) fn set(&mut self, n: usize, [q, v, a, f]: [f64; 4]) {
        (self.displacement[n], self.velocity[n]) = (q, v);
        (self.acceleration[n], self.joint_force[n]) = (a, f);
    }
}

/// The force at sample `n` of a history with one value per time step; zero after its end.
#[inline]
pub(crate) fn force_at(force: &[f64], n: usize) -> f64 {
    force.get(n).copied().unwrap_or(0.0)
}
