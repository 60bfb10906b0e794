//! The likelihood of records as a function, for samplers.

use std::f64::consts::TAU;

use crate::error::Error;
use crate::identify::{Identification, Prepared, Settings, Source};
use crate::parameters::{Parameter, Parameters};
use crate::refine::{RingDown, Task, Workspace};

/// Logarithm of the likelihood of the records behind an identification, up to a constant.
///
/// Residuals are those of the refinement, whitened; their variance is that about the best fit, widened where neighbours are
/// correlated, as in the profiles.
#[derive(Debug, Clone)]
pub struct Likelihood {
    task: Task,
    variance: f64,
    parameters: Parameters,
    starts: Vec<(f64, f64)>,
}

/// Buffers that evaluations one after the other share.
#[derive(Debug, Default)]
pub struct Buffers(Workspace);

impl Likelihood {
    /// Of the same records and settings that were identified.
    ///
    /// # Errors
    /// As [`identify`](crate::identify::identify).
    ///
    /// ```
    /// use iwan_core::{Decay, Reversal, Samples};
    /// use iwan_ident::{Parameters, curves::Quantity, identify::{Settings, Source, identify}, likelihood::{Buffers, Likelihood}};
    /// let truth = Parameters { frequency: 124.0, damping_ratio: 1e-3, k_t: 4.45e4, f_s: 239.4, chi: -0.183, beta: 0.3 };
    /// let (oscillator, joint) = truth.model()?;
    /// let (dt, mut out) = (2e-4, [vec![0.0; 2000], vec![0.0; 2000], vec![0.0; 2000], vec![0.0; 2000]]);
    /// let [displacement, velocity, acceleration, joint_force] = &mut out;
    /// Decay::new(&oscillator, &joint, 0.0, (0.2 * joint.phi_max(), 0.0), vec![Reversal::default(); 200])?
    ///     .sample(dt, &mut Samples { displacement, velocity, acceleration, joint_force })?;
    /// let source = Source { samples: &out[2], dt, quantity: Quantity::Acceleration };
    /// let found = identify(&[source], &Settings::default())?;
    /// let likelihood = Likelihood::new(&[source], &Settings::default(), &found)?;
    /// let (starts, mut buffers) = (likelihood.starts().to_vec(), Buffers::default());
    /// let best = likelihood.log(&found.parameters, &starts, &mut buffers).unwrap();
    /// let off = Parameters { chi: found.parameters.chi + 0.1, ..found.parameters };
    /// assert!(likelihood.log(&off, &starts, &mut buffers).unwrap() < best - 100.0);
    /// # Ok::<(), iwan_ident::Error>(())
    /// ```
    pub fn new(sources: &[Source<'_>], settings: &Settings, found: &Identification) -> Result<Self, Error> {
        let prepared =
            sources.iter().map(|source| Prepared::new(*source, settings)).collect::<Result<Vec<_>, _>>()?;
        let records: Vec<RingDown<'_>> = prepared.iter().map(Prepared::ring_down).collect();
        let held: Vec<Parameter> = settings.held.iter().map(|h| h.0).collect();
        let mut task = Task::new(&records, &found.fit.parameters, &held)?;
        let (parameters, starts) = (found.parameters, found.refined.starts.clone());
        let x = task.coordinates_at(&parameters, &starts)?;
        let mut work = Workspace::default();
        task.weigh(&x, &mut work);
        let freedom = (task.count() - task.free().len()) as f64;
        let correlation = found.refined.correlation;
        let significant = correlation > 2.0 / (task.count() as f64).sqrt();
        let inflation = if significant { (1.0 + correlation) / (1.0 - correlation.min(0.9)) } else { 1.0 };
        let cost = task.cost(&x, &mut work).unwrap_or(freedom);
        Ok(Self { task, variance: inflation * (cost / freedom).max(1.0), parameters, starts })
    }

    /// The best fit.
    #[must_use]
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// Of each record at the best fit: displacement at the turning point next to its first sample, and its time in s from there.
    #[must_use]
    pub fn starts(&self) -> &[(f64, f64)] {
        &self.starts
    }

    /// Time in s by which the phase of a start is one radian.
    #[must_use]
    pub fn radian(&self) -> f64 {
        1.0 / (TAU * self.parameters.frequency)
    }

    /// Logarithm of the likelihood of parameters and of each record's start; none where they are no model or there is
    /// no ring-down.
    #[must_use]
    pub fn log(&self, parameters: &Parameters, starts: &[(f64, f64)], buffers: &mut Buffers) -> Option<f64> {
        if starts.len() != self.starts.len() {
            return None;
        }
        let x = self.task.coordinates_at(parameters, starts).ok()?;
        let outside = self.task.bounds().iter().zip(&x).any(|((low, high), x)| !(low..=high).contains(&x));
        // What the coordinates cannot hold was brought inside their bounds: it is not what was asked for.
        let back = self.task.chart.parameters(&x);
        let moved =
            |p: Parameter| (back.get(p) - parameters.get(p)).abs() > 1e-6 * parameters.get(p).abs().max(1e-9);
        if outside || Parameter::ALL.into_iter().any(moved) {
            return None;
        }
        self.task.cost(&x, &mut buffers.0).map(|cost| -0.5 * cost / self.variance)
    }
}
