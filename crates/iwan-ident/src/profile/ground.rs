//! The ground that a walk goes over: a sum of squares as a function of coordinates between bounds.

use nalgebra::DMatrix;

use crate::parameters::Parameters;
use crate::refine::{Effort, Task, Workspace};
use crate::search::Minimum;

/// Part of ω0² above which K_T at the farthest accepted point opens an end: the walk then stopped at the model's limit K_T < ω0², and not at evidence
/// in the record.
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

    /// A second search with central derivatives from `found`, for a point that would end an interval; none where the first search had central
    /// derivatives.
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

    /// Whether a point lies next to the edge of what a model can be, so that an end of an interval there is open.
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

    /// Where a valley is narrow and bent, searches with one-sided derivatives end above its floor.
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

/// Whether the joint has nearly all stiffness of the mode.
pub(crate) fn is_all_joint(p: &Parameters) -> bool {
    p.k_t > MOST_JOINT * (std::f64::consts::TAU * p.frequency).powi(2)
}
