//! What a walk goes over: a sum of squares of coordinates between bounds.

use nalgebra::DMatrix;

use crate::parameters::Parameters;
use crate::refine::{Effort, Task, Workspace};
use crate::search::Minimum;

/// If the farthest accepted point has K_T > 0.9 ω0², the walk stopped at the model's limit K_T < ω0², not at evidence in the
/// record: the end is reported as open.
const MOST_JOINT: f64 = 0.9;

/// A sum of squares that profiles are taken of.
pub(crate) trait Ground {
    /// Buffers that evaluations one after the other share.
    type Work: Default;

    /// Lower and upper bound of each coordinate.
    fn bounds(&self) -> Vec<(f64, f64)>;

    /// The sum of squares; none where there is no model.
    fn cost(&self, x: &[f64], work: &mut Self::Work) -> Option<f64>;

    /// The least sum of squares over the coordinates in `free`, from `x`, until an iteration brings less than the relative `tolerance`.
    fn minimise(&self, x: &[f64], free: Vec<usize>, tolerance: f64, work: &mut Self::Work)
    -> Option<Minimum>;

    /// The same once more with central derivatives, for a point that would end an interval; none where the first search had them.
    fn deepened(
        &self,
        _found: &Minimum,
        _free: Vec<usize>,
        _tolerance: f64,
        _work: &mut Self::Work,
    ) -> Option<Minimum> {
        None
    }

    /// Derivatives of the residuals with respect to the coordinates in `free`, one column each.
    fn jacobian(&self, x: &[f64], free: Vec<usize>, work: &mut Self::Work) -> Option<DMatrix<f64>>;

    /// Whether a point lies next to the edge of what a model can be.
    fn is_at_edge(&self, x: &[f64]) -> bool;
}

impl Ground for Task {
    type Work = Workspace;

    fn bounds(&self) -> Vec<(f64, f64)> {
        Self::bounds(self)
    }

    fn cost(&self, x: &[f64], work: &mut Workspace) -> Option<f64> {
        Self::cost(self, x, work)
    }

    fn minimise(&self, x: &[f64], free: Vec<usize>, tolerance: f64, work: &mut Workspace) -> Option<Minimum> {
        Self::minimise(self, x, free, tolerance, work)
    }

    /// Where a valley is narrow and bent, searches with derivatives to one side end above its floor.
    fn deepened(
        &self,
        found: &Minimum,
        free: Vec<usize>,
        tolerance: f64,
        work: &mut Workspace,
    ) -> Option<Minimum> {
        let effort = Effort { central: true, ..Effort::until(tolerance) };
        self.widened.then(|| self.minimise_with(&found.x, free, effort, work)).flatten()
    }

    fn jacobian(&self, x: &[f64], free: Vec<usize>, work: &mut Workspace) -> Option<DMatrix<f64>> {
        self.linearised(x, free, work).map(|(_, slopes)| slopes)
    }

    fn is_at_edge(&self, x: &[f64]) -> bool {
        is_all_joint(&self.chart.parameters(x))
    }
}

/// Whether nearly all stiffness is the joint's.
pub(crate) fn is_all_joint(p: &Parameters) -> bool {
    p.k_t > MOST_JOINT * (std::f64::consts::TAU * p.frequency).powi(2)
}
