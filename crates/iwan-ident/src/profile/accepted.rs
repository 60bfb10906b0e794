//! The points that the records accept: at each knee the best of all others, and how far these can move there.

use nalgebra::{DMatrix, DVector};

use super::deviance::Scale;
use super::walk::Walk;
use crate::parameters::{COUNT, Parameter};
use crate::refine::{Effort, Task, Workspace};
use crate::search::Minimum;

/// Relative reduction of the sum of squares at which the searches of a sweep end: the deviance then stands to a hundredth.
const TOLERANCE: f64 = 1e-5;
/// Half step of the differences of a parameter with respect to the coordinates: these are closed forms, and central differences are
/// best near the cube root of rounding.
const STEP: f64 = 1e-5;

/// A point within the limit, with what is left of the deviance there.
#[derive(Debug, Clone)]
pub(super) struct Accepted {
    pub(super) minimum: Minimum,
    pub(super) deviance: f64,
    /// Inverse of the triangular factor of the residuals' derivatives with respect to the smooth unknowns.
    spread: Option<DMatrix<f64>>,
}

/// All points within the limit, and whether they reach the ends of the range of knees.
pub(super) struct Region {
    pub(super) points: Vec<Accepted>,
    /// The largest knee that was tried is accepted: the records do not tell an upper end.
    pub(super) to_largest_knee: bool,
    /// The smallest one is.
    pub(super) to_smallest_knee: bool,
}

impl Region {
    /// From the minimum along all knees, or where the knee is not sought the minimum alone.
    ///
    /// # Errors
    /// A better minimum.
    pub(super) fn new(task: &Task, minimum: &Minimum, scale: &Scale) -> Result<Self, Minimum> {
        let mut work = Workspace::default();
        let mut found = vec![minimum.clone()];
        let (mut to_largest_knee, mut to_smallest_knee) = (false, false);
        if let Some(knee) = task.knee() {
            let knees = task.knees();
            let (high, low) = (knees[0], knees[knees.len() - 1]);
            let limit = minimum.cost + scale.limit * scale.variance;
            found = task.sweep(minimum, limit, TOLERANCE, &mut work);
            found.extend(task.polished(&found, &mut work));
            for direction in [-1.0, 1.0] {
                let mut walk = Walk::new(task, knee, task.smooth(), minimum, scale);
                walk.go(direction)?;
                found.extend(walk.visited.into_iter().map(|v| v.minimum));
            }
            let inside = |m: &&Minimum| scale.rise(m) < scale.limit;
            to_largest_knee = found.iter().filter(inside).any(|m| m.x[knee] >= high);
            to_smallest_knee = found.iter().filter(inside).any(|m| m.x[knee] <= low);
        }
        let best = found.iter().min_by(|a, b| a.cost.total_cmp(&b.cost));
        if let Some(better) = best.filter(|m| scale.rise(m) < scale.better) {
            return Err(better.clone());
        }
        found.retain(|m| scale.rise(m) < scale.limit);
        let points = found.into_iter().map(|m| Accepted::new(task, m, scale, &mut work)).collect();
        Ok(Self { points, to_largest_knee, to_smallest_knee })
    }
}

impl Accepted {
    fn new(task: &Task, minimum: Minimum, scale: &Scale, work: &mut Workspace) -> Self {
        let search = task.search(task.smooth(), Effort { iterations: 0, tolerance: 0.0 });
        let mut residuals = |x: &[f64], out: &mut [f64]| task.residuals(x, out, work);
        let mut r = vec![0.0; task.count()];
        residuals(&minimum.x, &mut r);
        let jacobian = search.jacobian(&mut residuals, &minimum.x, &r);
        let spread = jacobian.and_then(|j| j.qr().r().try_inverse());
        Self { deviance: scale.rise(&minimum).max(0.0), minimum, spread }
    }

    /// How far a parameter (its logarithm where it has one) can go from here in the linearised model before the limit is reached.
    pub(super) fn reach(&self, task: &Task, scale: &Scale, parameter: Parameter) -> f64 {
        let Some(spread) = &self.spread else { return 0.0 };
        let slope = |j: &usize| {
            if *j >= COUNT {
                return 0.0;
            }
            let at = |by: f64| {
                let mut x = self.minimum.x.clone();
                x[*j] += by;
                scaled(parameter, task.chart.parameters(&x).get(parameter))
            };
            (at(STEP) - at(-STEP)) / (2.0 * STEP)
        };
        let smooth = task.smooth();
        let slopes = DVector::from_iterator(smooth.len(), smooth.iter().map(slope));
        let left = (scale.limit - self.deviance).max(0.0);
        (spread.transpose() * slopes).norm() * (scale.variance * left).sqrt()
    }

    pub(super) fn value(&self, task: &Task, parameter: Parameter) -> f64 {
        task.chart.parameters(&self.minimum.x).get(parameter)
    }
}

/// The scale on which intervals are sought: logarithms of what is positive.
pub(super) fn scaled(parameter: Parameter, value: f64) -> f64 {
    match parameter {
        Parameter::DampingRatio | Parameter::Chi => value,
        Parameter::Beta => value / (1.0 + value),
        _ => value.ln(),
    }
}
