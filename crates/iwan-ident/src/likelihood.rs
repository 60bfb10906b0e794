//! The likelihood of records as a function, for samplers.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use crate::parameters::Parameters;
use crate::refine::{Task, TurningPoint, Workspace};

/// Logarithm of the likelihood of the records behind an identification, up to a constant.
///
/// It is the likelihood of the complex amplitudes in windows that [`refine`](mod@crate::refine) compares, whitened. Their variance is
/// that about the best fit, widened where neighbours are correlated, as in the profiles.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Likelihood {
    task: Task,
    /// Variance of the residuals in their unit.
    variance: f64,
    parameters: Parameters,
    starts: Vec<TurningPoint>,
}

/// Memory that successive evaluations share.
#[derive(Debug, Default)]
pub struct Buffers {
    work: Workspace,
    residuals: Vec<f64>,
}

impl Likelihood {
    pub(crate) fn new(task: &Task, variance: f64, parameters: &Parameters, starts: &[TurningPoint]) -> Self {
        Self { task: task.clone(), variance, parameters: *parameters, starts: starts.to_vec() }
    }

    /// The best fit.
    #[must_use]
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// The turning point next to the first sample of each record, at the best fit.
    #[must_use]
    pub fn starts(&self) -> &[TurningPoint] {
        &self.starts
    }

    /// Whether the frequency differs from day to day, so that each turning point has a `day` that is sought with the rest.
    #[must_use]
    pub fn has_days(&self) -> bool {
        self.task.has_days()
    }

    /// Time in s in which the phase of a start changes by one radian.
    #[must_use]
    pub fn radian(&self) -> f64 {
        1.0 / (TAU * self.parameters.frequency)
    }

    /// Number of residuals.
    pub(crate) fn count(&self) -> usize {
        self.task.count()
    }

    /// Residuals in standard deviations; false where the parameters have no ring-down.
    pub(crate) fn residuals(
        &self,
        parameters: &Parameters,
        starts: &[TurningPoint],
        out: &mut [f64],
        buffers: &mut Buffers,
    ) -> bool {
        let known = starts.len() == self.starts.len()
            && self.task.residuals_of(parameters, starts, out, &mut buffers.work);
        let deviation = self.variance.sqrt();
        for r in out.iter_mut() {
            *r /= deviation;
        }
        known
    }

    /// ln of the likelihood of parameters and of each record's start, less that of a perfect match: -½ Σ r²/σ². None where
    /// the parameters are no model or have no ring-down, and where there are not as many starts as records.
    ///
    /// An example: [`identify`](crate::identify::identify).
    #[must_use]
    pub fn log(
        &self,
        parameters: &Parameters,
        starts: &[TurningPoint],
        buffers: &mut Buffers,
    ) -> Option<f64> {
        buffers.residuals.resize(self.task.count(), 0.0);
        let known = starts.len() == self.starts.len()
            && self.task.residuals_of(parameters, starts, &mut buffers.residuals, &mut buffers.work);
        let square: f64 = buffers.residuals.iter().map(|r| r * r).sum();
        (known && square.is_finite()).then(|| -0.5 * square / self.variance)
    }
}
