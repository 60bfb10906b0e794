//! The unit of deviances, and the largest deviance inside a 95 % interval.

use crate::refine::Task;
use crate::search::Minimum;
use crate::student::{LEAST_FREEDOM, student};

/// Deviance below which a point counts as a better minimum, from which the search begins anew: a fortieth of the limit of 3.84, which moves no end of
/// an interval by more than 1.3 %. Smaller differences are a tolerance of the searches.
const BETTER: f64 = -0.1;

/// Relative reduction of the sum of squares at which a search along a profile ends: nearly a hundredth of the residuals' variance.
const TOLERANCE: f64 = 1e-5;
/// Part of the rise of the sum of squares up to an interval's end that a search along the profile may leave, where this is more than `TOLERANCE`: it
/// moves the end by half of that part. Intervals that allow for what a model misses are as wide as a rise of several times the least sum of squares.
const LEFT: f64 = 1e-3;

/// The same part for searches at the knees of a sweep, which say whether a knee is accepted and where walks begin: walks along the knee and along each parameter find the ends themselves.
const LEFT_BY_SWEEPS: f64 = 0.02;

/// The unit and the limit of deviance that all profiles of a task share.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scale {
    /// Least sum of squares, that of the best fit.
    pub(crate) least: f64,
    /// Variance of the residuals, in the unit in which they are compared.
    pub(crate) variance: f64,
    pub(crate) limit: f64,
    /// Deviance below which a point counts as a better minimum.
    pub(crate) better: f64,
    /// Whether the root of the deviance grows evenly along a walk. Along the parameters of a mode it does not, because other knees take over on the way: an end on the line between
    /// two points put the damping ratio's lower end at 1.3 times the truth.
    pub(crate) even: bool,
}

impl Scale {
    pub(super) fn new(task: &Task, minimum: &Minimum, settled: bool) -> Self {
        let freedom = (task.count() - task.free().len()) as f64;
        let refined = task.refined(minimum);
        let r = refined.correlation;
        // The allowance for a clean record is in units of the noise that was found with it: a sum of squares that is smaller by chance does not make
        // the allowance smaller.
        // Nor does a sum of squares that is smaller than what is known to remain of other modes.
        let least = if task.widened || task.is_beside_others() { 1.0 } else { task.least_variance() };
        // Neighbouring residuals that are correlated say the same twice.
        let inflation = if refined.leaves_noise(task.count()) { 1.0 } else { (1.0 + r) / (1.0 - r.min(0.9)) };
        // Neighbours that alternate make no interval narrower: what the law misses was set aside, and the correlation of the rest is one of few values.
        let inflation = inflation.max(1.0);
        Self {
            least: minimum.cost,
            variance: inflation * (minimum.cost / freedom).max(least),
            limit: student((freedom / inflation).max(LEAST_FREEDOM)).powi(2),
            better: if settled { f64::NEG_INFINITY } else { BETTER },
            even: false,
        }
    }

    /// The scale about a least sum of squares, with a variance on `freedom` degrees of freedom that is known or found elsewhere.
    pub(crate) fn about(least: f64, variance: f64, freedom: f64) -> Self {
        Self {
            least,
            variance,
            limit: student(freedom.max(LEAST_FREEDOM)).powi(2),
            better: BETTER,
            even: true,
        }
    }

    /// Deviance of a point: the rise of the sum of squares over its least value, in units of the variance.
    pub(crate) fn rise(&self, found: &Minimum) -> f64 {
        (found.cost - self.least) / self.variance
    }

    /// Relative reduction of the sum of squares at which a search along the profile ends.
    pub(super) fn tolerance(&self) -> f64 {
        self.leaving(LEFT)
    }

    /// The same for searches at the knees of a sweep.
    pub(super) fn tolerance_of_sweeps(&self) -> f64 {
        self.leaving(LEFT_BY_SWEEPS)
    }

    fn leaving(&self, part: f64) -> f64 {
        let rise = self.limit * self.variance;
        TOLERANCE.max(part * rise / (self.least + rise))
    }
}
