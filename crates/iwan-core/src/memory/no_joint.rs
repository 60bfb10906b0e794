//! The joint of a linear mode: none.

use super::hysteresis::{Hysteresis, Trial};

/// No joint: no force, no memory. The state is the displacement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct NoJoint;

impl Hysteresis<f64> for NoJoint {
    fn displacement(&self, state: &f64) -> f64 {
        *state
    }

    fn joint_force(&self, _: &f64) -> f64 {
        0.0
    }

    fn advance(&self, state: &mut f64, u: f64) -> f64 {
        *state = u;
        0.0
    }

    fn solve(&self, state: &mut f64, stiffness: f64, load: f64) -> f64 {
        let du = load / stiffness;
        *state += du;
        du
    }

    fn stored_energy(&self, _: &f64) -> f64 {
        0.0
    }
}

impl Trial<f64> for NoJoint {
    fn trial(&self, _: &f64, _: f64) -> (f64, f64) {
        (0.0, 0.0)
    }
}
