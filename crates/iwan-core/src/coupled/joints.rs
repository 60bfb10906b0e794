//! The joints within a time step of coupled modes: from the slips with N held constant to the slips and forces at the step's end.

use super::lanes::Lanes;
use super::modes::CoupledModes;
use crate::error::Error;
use crate::memory::Hysteresis;

/// Joints that move with coupled modes.
pub trait JointsInMotion {
    /// Number of joints.
    fn count(&self) -> usize;

    /// Moves the joints by Δs = `ahead` - c ΔN, which is an implicit equation in the slips, and writes ΔN to `change`. If `ahead` is not
    /// finite, the changes are not finite either.
    ///
    /// # Errors
    /// [`Error::Unsupported`] when no solution is found.
    fn solve<S: AsRef<[Lanes]> + AsMut<[Lanes]>>(
        &mut self,
        modes: &CoupledModes<S>,
        ahead: &[f64],
        change: &mut [f64],
    ) -> Result<(), Error>;

    /// The same equation without inertia, for a static load: the compliance ρ stands in place of c.
    ///
    /// # Errors
    /// As [`solve`](Self::solve).
    fn settle<S: AsRef<[Lanes]> + AsMut<[Lanes]>>(
        &mut self,
        modes: &CoupledModes<S>,
        ahead: &[f64],
    ) -> Result<(), Error>;

    /// Slip s of joint `index`.
    fn slip(&self, index: usize) -> f64;

    /// Force F of joint `index`.
    fn force(&self, index: usize) -> f64;

    /// Energy in the springs of joint `index`.
    fn stored_energy(&self, index: usize) -> f64;
}

/// One joint of any law and memory. Its step has the same form as that of a single mode.
#[derive(Debug)]
pub struct OneJoint<'a, J, State> {
    law: &'a J,
    state: &'a mut State,
}

impl<'a, State, J: Hysteresis<State>> OneJoint<'a, J, State> {
    /// A law and its state.
    pub fn new(law: &'a J, state: &'a mut State) -> Self {
        Self { law, state }
    }

    /// The law and its state.
    pub fn parts(&mut self) -> (&'a J, &mut State) {
        (self.law, self.state)
    }
}

impl<State, J: Hysteresis<State>> JointsInMotion for OneJoint<'_, J, State> {
    fn count(&self) -> usize {
        1
    }

    /// Solves (1/c - K) Δs + ΔF = Δs*/c.
    #[inline]
    fn solve<S: AsRef<[Lanes]> + AsMut<[Lanes]>>(
        &mut self,
        modes: &CoupledModes<S>,
        ahead: &[f64],
        change: &mut [f64],
    ) -> Result<(), Error> {
        let (inverse, k) = (1.0 / modes.coupling()[0], modes.joint_stiffness()[0]);
        let before = self.law.joint_force(self.state);
        let way = self.law.solve(self.state, inverse - k, inverse * ahead[0]);
        change[0] = (self.law.joint_force(self.state) - before) - k * way;
        Ok(())
    }

    fn settle<S: AsRef<[Lanes]> + AsMut<[Lanes]>>(
        &mut self,
        modes: &CoupledModes<S>,
        ahead: &[f64],
    ) -> Result<(), Error> {
        let (rho, k) = (modes.compliance()[0], modes.joint_stiffness()[0]);
        if rho * k > 0.0 && (1.0 / rho).is_finite() {
            self.law.solve(self.state, 1.0 / rho - k, ahead[0] / rho);
        } else {
            let to = self.law.displacement(self.state) + ahead[0];
            self.law.advance(self.state, to);
        }
        Ok(())
    }

    fn slip(&self, _: usize) -> f64 {
        self.law.displacement(self.state)
    }

    fn force(&self, _: usize) -> f64 {
        self.law.joint_force(self.state)
    }

    fn stored_energy(&self, _: usize) -> f64 {
        self.law.stored_energy(self.state)
    }
}
