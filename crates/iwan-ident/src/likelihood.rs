//! The likelihood of records, for samplers.

use crate::parameters::Parameters;
use crate::refine::{Task, Workspace};

/// How likely records are, as a function of parameters and of each record's turning point: that of the complex amplitudes
/// in windows that [`refine`](mod@crate::refine) compares, with the residual variance of the best fit.
///
/// Evaluations share buffers: a clone for each thread.
#[derive(Debug, Clone)]
pub struct Likelihood {
    task: Task,
    /// Variance of the residuals in their unit.
    variance: f64,
    starts: Vec<(f64, f64)>,
    work: Workspace,
    residuals: Vec<f64>,
}

impl Likelihood {
    pub(crate) fn new(task: &Task, variance: f64, starts: Vec<(f64, f64)>) -> Self {
        let residuals = vec![0.0; task.count()];
        Self { task: task.clone(), variance, starts, work: Workspace::default(), residuals }
    }

    /// Number of real values that are compared.
    #[must_use]
    pub fn values(&self) -> usize {
        self.residuals.len()
    }

    /// Displacement and time (s) of each record's turning point in the best fit.
    #[must_use]
    pub fn starts(&self) -> &[(f64, f64)] {
        &self.starts
    }

    /// ln of the likelihood, less that of a perfect fit: -½ Σ r²/σ². Minus infinity where there is no model, and with a
    /// number of starts other than that of the records.
    ///
    /// # Example
    /// See [`identify`](crate::identify::identify).
    #[must_use]
    pub fn log(&mut self, parameters: &Parameters, starts: &[(f64, f64)]) -> f64 {
        let known = starts.len() == self.starts.len()
            && self.task.residuals_of(parameters, starts, &mut self.residuals, &mut self.work);
        let square: f64 = self.residuals.iter().map(|r| r * r).sum();
        if known && square.is_finite() { -0.5 * square / self.variance } else { f64::NEG_INFINITY }
    }
}
