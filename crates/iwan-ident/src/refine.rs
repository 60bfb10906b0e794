//! Simulation in the loop: the parameters whose ring-down is the record itself.
//!
//! Forward model: the half-cycle map of iwan-core; compared are complex amplitudes in windows (the module `features`),
//! taken of record and model alike. Each record brings two unknowns of its own: amplitude and time of the turning point
//! next to its first sample. The joint is taken to have been loaded along its virgin curve up to there: exact for
//! a release from rest; later in a decay, where loops shrink slowly, the tips of the loops lie next to the virgin curve.
//!
//! First the logarithms of the amplitudes, with unwrapped phases, are brought together from several starts: no cycle is
//! lost on the way. Then the amplitudes themselves, weighted by each record's noise.

mod record;
mod search;

use std::f64::consts::{PI, TAU};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use iwan_core::Reversal;
use rustfft::num_complex::Complex64;

use crate::chart::Chart;
use crate::curves::Quantity;
use crate::error::{Error, check};
use crate::least_squares::{Minimum, Search};
use crate::parameters::{COUNT, Parameter, Parameters};
use record::Prepared;
pub(crate) use search::KNEE_UNSEEN;

/// Unknowns of each record: ln of the first amplitude, phase of the release.
const OWN: usize = 2;
/// Iterations of the first search from each start, and of the last.
const ITERATIONS: (usize, usize) = (30, 100);
/// Relative reduction of the sum of squares at which searches end that are not the last.
const ROUGH: f64 = 1e-4;
/// … and of searches for a minimum under noise.
const FINE: f64 = 2e-6;
/// Standard deviation that is put down to the forward model's own error, relative to a record's amplitudes.
const NOISE_FLOOR: f64 = 1e-6;

/// A ring-down in free decay: one mode, mass-normalised.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RingDown<'a> {
    /// Samples, free of aliases.
    pub samples: &'a [f64],
    /// Sampling interval, s.
    pub dt: f64,
    /// What was measured.
    pub quantity: Quantity,
    /// Width in Hz of the band that the samples were filtered to; none: unfiltered.
    pub band: Option<f64>,
}

/// Parameters that reproduce records, and what is left over.
#[derive(Debug, Clone, PartialEq)]
pub struct Refined {
    /// The parameters.
    pub parameters: Parameters,
    /// Of each record: displacement at the turning point next to the first sample, and its time in s from there.
    pub starts: Vec<(f64, f64)>,
    /// Standard deviation of white noise in a record's samples that would leave the same residuals, unit of the record.
    pub noise: Vec<f64>,
    /// Root mean square of all residuals over that of the records' amplitudes.
    pub relative_residual: f64,
    /// Correlation of neighbouring residuals: near 0 when only noise is left, near 1 when the model misses something.
    pub correlation: f64,
    /// Whether the search ended by itself.
    pub converged: bool,
}

impl Refined {
    /// Whether what is left of `count` values looks like white noise: neighbours are not correlated.
    pub(crate) fn leaves_noise(&self, count: usize) -> bool {
        self.correlation < 2.0 / (count as f64).sqrt()
    }
}

/// The records in the form that the searches work on.
#[derive(Debug, Clone)]
pub(crate) struct Task {
    pub(crate) chart: Chart,
    records: Vec<Prepared>,
    held: Vec<Parameter>,
    /// Once set there are no residuals any more, so that every search ends.
    pub(crate) stopped: Arc<AtomicBool>,
}

/// Buffers that all evaluations of a search share.
#[derive(Debug, Clone, Default)]
pub(crate) struct Workspace {
    stack: Vec<Reversal>,
    model: Vec<Complex64>,
}

impl Task {
    /// Checks the records; `first` gives the frequency that the windows refer to.
    pub(crate) fn new(
        records: &[RingDown<'_>],
        first: &Parameters,
        held: &[Parameter],
    ) -> Result<Self, Error> {
        check("records", records.len() as f64, !records.is_empty(), "at least one", "give a record")?;
        let records = records.iter().map(|r| Prepared::new(r, first)).collect::<Result<Vec<_>, _>>()?;
        let middle = |r: &Prepared| (r.start.0.abs().ln(), 1.0);
        let sum = records.iter().map(middle).fold((0.0, 0.0), |s, m| (s.0 + m.0, s.1 + m.1));
        let amplitude = (sum.0 / sum.1 - 1.0).exp();
        let chart = Chart::holding(held, amplitude);
        let task = Self { chart, records, held: held.to_vec(), stopped: Arc::default() };
        let needed = COUNT + OWN * task.records.len() + 3;
        if task.count() < needed {
            let remedy = "record longer";
            return Err(Error::TooShort {
                what: "independent amplitudes",
                found: task.count(),
                needed,
                remedy,
            });
        }
        Ok(task)
    }

    /// Number of residuals.
    pub(crate) fn count(&self) -> usize {
        self.records.iter().map(|r| 2 * r.windows.count).sum()
    }

    pub(crate) fn held(&self) -> &[Parameter] {
        &self.held
    }

    /// Unknowns without those that are held.
    pub(crate) fn free(&self) -> Vec<usize> {
        let all = COUNT + OWN * self.records.len();
        (0..all).filter(|j| self.held.iter().all(|h| self.chart.index(*h) != *j)).collect()
    }

    pub(crate) fn bounds(&self) -> Vec<(f64, f64)> {
        let own = [(-3.0, 3.0), (-0.5 * PI, 0.5 * PI)];
        self.chart.bounds().into_iter().chain(self.records.iter().flat_map(|_| own)).collect()
    }

    pub(crate) fn coordinates(&self, parameters: &Parameters) -> Result<Vec<f64>, Error> {
        let mut x = self.chart.coordinates(parameters)?.to_vec();
        x.resize(COUNT + OWN * self.records.len(), 0.0);
        Ok(x)
    }

    /// Whitened residuals over each record's standard deviation.
    pub(crate) fn residuals(&self, x: &[f64], out: &mut [f64], work: &mut Workspace) -> bool {
        let starts = self.starts_at(x);
        self.residuals_of(&self.chart.parameters(x), &starts, out, work)
    }

    /// The same for parameters and the turning points of the records.
    pub(crate) fn residuals_of(
        &self,
        parameters: &Parameters,
        starts: &[(f64, f64)],
        out: &mut [f64],
        work: &mut Workspace,
    ) -> bool {
        self.each_model(parameters, starts, work, |record, model, range| {
            record.whitening.apply(model);
            let left = record.white.iter().zip(model.iter()).map(|(z, m)| (z - m) / record.scale);
            out[range].chunks_exact_mut(2).zip(left).for_each(|(o, r)| (o[0], o[1]) = (r.re, r.im));
        })
    }

    /// Displacement and time of each record's turning point.
    fn starts_at(&self, x: &[f64]) -> Vec<(f64, f64)> {
        let omega = TAU * self.chart.parameters(x).frequency;
        let own = x[COUNT..].chunks_exact(OWN);
        own.zip(&self.records).map(|(own, record)| record.start_at(own, omega)).collect()
    }

    /// Whitened sum of squares; none where there is no model.
    pub(crate) fn cost(&self, x: &[f64], work: &mut Workspace) -> Option<f64> {
        let mut out = vec![0.0; self.count()];
        let cost = self.residuals(x, &mut out, work).then(|| out.iter().map(|r| r * r).sum::<f64>());
        cost.filter(|c| c.is_finite())
    }

    /// Differences of log amplitudes and of unwrapped phases, weighted by amplitude.
    fn log_residuals(&self, x: &[f64], out: &mut [f64], work: &mut Workspace) -> bool {
        out.fill(0.0);
        let starts = self.starts_at(x);
        self.each_model(&self.chart.parameters(x), &starts, work, |record, model, range| {
            let loud = record.loud();
            let loudest = record.amplitudes.iter().map(|z| z.norm()).fold(0.0, f64::max);
            let mut turned = (Complex64::new(1.0, 0.0), 0.0);
            for (k, o) in out[range].chunks_exact_mut(2).enumerate().take(loud) {
                let ratio = record.amplitudes[k] / model[k];
                let angle = turned.1 + (ratio / turned.0).arg();
                turned = (ratio, angle);
                let weight = record.amplitudes[k].norm() / loudest;
                (o[0], o[1]) = (weight * ratio.norm().max(f64::MIN_POSITIVE).ln(), weight * angle);
            }
        })
    }

    fn each_model(
        &self,
        parameters: &Parameters,
        starts: &[(f64, f64)],
        work: &mut Workspace,
        mut compare: impl FnMut(&Prepared, &mut [Complex64], std::ops::Range<usize>),
    ) -> bool {
        if self.stopped.load(Ordering::Relaxed) {
            return false;
        }
        let mut from = 0;
        for (start, record) in starts.iter().zip(&self.records) {
            work.model.resize(record.windows.count, Complex64::default());
            let (stack, model) = (&mut work.stack, &mut work.model);
            if !record.windows.of_model(parameters, *start, record.quantity, stack, model) {
                return false;
            }
            compare(record, model, from..from + 2 * record.windows.count);
            from += 2 * record.windows.count;
        }
        true
    }

    pub(crate) fn search(&self, free: Vec<usize>, (iterations, tolerance): (usize, f64)) -> Search {
        Search { count: self.count(), free, bounds: self.bounds(), iterations, tolerance }
    }

    /// The least whitened sum of squares from `x`, until an iteration brings less than the relative `tolerance`.
    pub(crate) fn minimise(
        &self,
        x: &[f64],
        free: Vec<usize>,
        tolerance: f64,
        work: &mut Workspace,
    ) -> Option<Minimum> {
        let iterations = if tolerance > FINE { ITERATIONS.0 } else { ITERATIONS.1 };
        let mut residuals = |x: &[f64], out: &mut [f64]| self.residuals(x, out, work);
        self.search(free, (iterations, tolerance)).run(&mut residuals, x)
    }

    /// Sets each record's standard deviation to that of its residuals at `x`.
    fn weigh(&mut self, x: &[f64], work: &mut Workspace) {
        let mut out = vec![0.0; self.count()];
        if !self.residuals(x, &mut out, work) {
            return;
        }
        let unknowns = self.free().len() as f64 / self.records.len() as f64;
        let mut from = 0;
        for record in &mut self.records {
            let n = 2 * record.windows.count;
            let square: f64 = out[from..from + n].iter().map(|r| r * r).sum();
            let deviation = record.scale * (square / (n as f64 - unknowns).max(1.0)).sqrt();
            record.scale = deviation.max(1e-3 * NOISE_FLOOR * record.root_mean_square());
            from += n;
        }
    }

    /// Variance of residuals that the forward model itself accounts for.
    pub(crate) fn least_variance(&self) -> f64 {
        let floor = |r: &Prepared| (NOISE_FLOOR * r.root_mean_square() / r.scale).powi(2);
        self.records.iter().map(floor).fold(0.0, f64::max)
    }

    pub(crate) fn refined(&self, minimum: &Minimum) -> Refined {
        let mut out = vec![0.0; self.count()];
        self.residuals(&minimum.x, &mut out, &mut Workspace::default());
        let parameters = self.chart.parameters(&minimum.x);
        let (mut noise, mut square, mut total, mut product, mut from) = (vec![], 0.0, 0.0, 0.0, 0);
        for record in &self.records {
            let n = 2 * record.windows.count;
            let part = &out[from..from + n];
            let sum: f64 = part.iter().map(|r| r * r).sum();
            // Density of the noise in each quadrature is half the variance of a sample times dt.
            noise.push(record.scale * (sum / n as f64).sqrt() * (2.0 / record.dt).sqrt());
            square += sum * record.scale.powi(2);
            total += record.root_mean_square().powi(2) * record.windows.count as f64;
            product += part.iter().zip(&part[2..]).map(|(a, b)| a * b).sum::<f64>();
            from += n;
        }
        Refined {
            parameters,
            starts: self.starts_at(&minimum.x),
            noise,
            relative_residual: (square / total).sqrt(),
            correlation: product / minimum.cost.max(f64::MIN_POSITIVE),
            converged: minimum.converged,
        }
    }
}

fn no_ring_down() -> Error {
    let finding = "the start values have no ring-down".into();
    Error::Refused { finding, remedy: "start nearer to the solution" }
}

/// Refines parameters on the records themselves, several force levels at once; those in `held` keep their values.
///
/// # Errors
/// [`Error::OutOfRange`], [`Error::NotFinite`], [`Error::TooShort`]; [`Error::Model`] when `first` is no model;
/// [`Error::Refused`] when no search succeeds.
///
/// ```
/// use iwan_core::{Decay, Reversal, Samples};
/// use iwan_ident::{Parameters, curves::Quantity, refine::{RingDown, refine}};
/// let truth = Parameters { frequency: 124.0, damping_ratio: 1e-3, k_t: 4.45e4, f_s: 239.4, chi: -0.183, beta: 0.3 };
/// let (oscillator, joint) = truth.model()?;
/// let mut out = [vec![0.0; 1000], vec![0.0; 1000], vec![0.0; 1000], vec![0.0; 1000]];
/// let [displacement, velocity, acceleration, joint_force] = &mut out;
/// let start = iwan_core::Motion::held_at(1.5 * joint.phi_max());
/// Decay::new(&oscillator, &joint, 0.0, start, vec![Reversal::default(); 99])?
///     .sample(2e-4, &mut Samples { displacement, velocity, acceleration, joint_force })?;
/// let record = RingDown { samples: &out[2], dt: 2e-4, quantity: Quantity::Acceleration, band: None };
/// let first = Parameters { k_t: 5e4, f_s: 220.0, chi: -0.3, beta: 0.5, ..truth };
/// let refined = refine(&[record], &first, &[])?;
/// assert!((refined.parameters.f_s / truth.f_s - 1.0).abs() < 1e-3);
/// # Ok::<(), iwan_ident::Error>(())
/// ```
pub fn refine(records: &[RingDown<'_>], first: &Parameters, held: &[Parameter]) -> Result<Refined, Error> {
    first.model()?;
    let mut task = Task::new(records, first, held)?;
    let rough = task.solve(first)?;
    let minimum = task.finish(&rough)?;
    Ok(task.refined(&minimum))
}
