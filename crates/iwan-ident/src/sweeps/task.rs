//! All measurements of a mode as one least-squares problem.

use std::f64::consts::{FRAC_PI_2, LN_10, TAU};

use nalgebra::{Cholesky, Matrix2, Vector2};

use super::balance::DayMode;
use super::data::SteadyData;
use crate::error::Error;
use crate::likelihood::{Buffers, Likelihood};
use crate::parameters::{COUNT, Parameter, Parameters};
use crate::refine::TurningPoint;
use crate::search::{Chart, DIRAC, Minimum, Search};

/// Index of the other modes' flexibility among the unknowns, which is in units of 1/ω0² of the first guess; the drifts of the measurements stand behind it.
pub(super) const OTHERS: usize = COUNT;
/// Relative drift of the frequency whose coordinate is 1: what a few kelvin do to steel.
const DRIFT_UNIT: f64 = 1e-4;
/// Largest relative drift: a frequency that differs by more than a tenth is that of another mode.
const MOST_DRIFT: f64 = 0.1;
/// Least relative error of a measurement: below it there is only rounding.
const LEAST_ERROR: f64 = 1e-9;
/// Range of knees φ_max that are tried, over the largest amplitude.
const KNEES: [f64; 2] = [0.05, 10.0];
/// Number of knees tried in a decade.
const PER_DECADE: f64 = 8.0;
/// Within this distance of the largest amplitude (as a natural logarithm) more knees are tried, because few amplitudes lie beyond the knee there. With eight in a decade a
/// knee at 0.9 of the largest amplitude was passed over, and curves without noise were fitted by a joint that sticks, with an error of 0.8 % and a frequency that the interval
/// excluded.
const NEAR: f64 = 0.7;
/// Number of knees tried in a decade there.
const CLOSE_PER_DECADE: f64 = 40.0;
/// Number of unknowns of each ring-down: ln of its release amplitude over the one found before, and its phase.
const OWN: usize = 2;

/// A measurement with its weights.
#[derive(Debug, Clone)]
pub(super) struct Weighted<'a> {
    pub(super) data: &'a SteadyData,
    /// Whitening factor of each point of a response: the inverse Cholesky factor of the covariance of its unbalanced force for relative errors of size one.
    factors: Vec<Matrix2<f64>>,
    /// Relative errors: for a response that of force and motion, twice; for a backbone those of its frequency and its damping.
    pub(super) errors: [f64; 2],
}

/// The measurements of a mode, and the ring-downs beside them, as one problem.
#[derive(Debug, Clone)]
pub(super) struct Task<'a> {
    pub(super) chart: Chart,
    pub(super) sets: Vec<Weighted<'a>>,
    ring_downs: Option<&'a Likelihood>,
    pub(super) held: Vec<Parameter>,
    /// ω0² of the first guess.
    unit: f64,
    /// Whether a response is among the measurements, so that other modes show.
    responses: bool,
    /// Lower bound of the knee's coordinate; it lies beyond all amplitudes where macro-slip is left out.
    least_knee: f64,
}

impl<'a> Task<'a> {
    pub(super) fn new(
        sets: &'a [SteadyData],
        ring_downs: Option<&'a Likelihood>,
        held: &[Parameter],
        first: &Parameters,
    ) -> Self {
        let all = || sets.iter().flat_map(SteadyData::amplitudes);
        let count = all().count() as f64;
        let amplitude = (all().map(f64::ln).sum::<f64>() / count).exp();
        let weighted = |data: &'a SteadyData| Weighted {
            data,
            factors: first_factors(data),
            errors: first_errors(data),
        };
        Self {
            chart: Chart::holding(held, amplitude),
            sets: sets.iter().map(weighted).collect(),
            ring_downs,
            held: held.to_vec(),
            unit: (TAU * first.frequency).powi(2),
            responses: sets.iter().any(|data| matches!(data, SteadyData::Response(_))),
            least_knee: f64::NEG_INFINITY,
        }
    }

    /// The same problem without macro-slip: the knee lies beyond all amplitudes measured.
    pub(super) fn without_slip(&self) -> Self {
        Self { least_knee: self.largest_knee(), ..self.clone() }
    }

    /// Coordinate of a knee at the largest amplitude measured.
    pub(super) fn largest_knee(&self) -> f64 {
        let largest = self.sets.iter().flat_map(|set| set.data.amplitudes()).fold(0.0, f64::max);
        (largest / self.chart.amplitude).ln()
    }

    /// Index of the knee among the coordinates, if it is sought.
    pub(super) fn knee(&self) -> Option<usize> {
        self.chart.knee().filter(|j| self.free().contains(j))
    }

    /// Lowest and highest coordinate of the knee in the search: from a twentieth of the largest amplitude, where next to everything
    /// measured would be macro-slip, to where nothing tells the knee from one farther away.
    pub(super) fn knee_range(&self) -> [f64; 2] {
        let largest = self.largest_knee();
        [(largest + KNEES[0].ln()).max(self.least_knee), largest + KNEES[1].ln()]
    }

    /// Coordinates of the knees that are tried through the whole range, the largest first.
    pub(super) fn knees(&self) -> Vec<f64> {
        let [low, high] = self.knee_range();
        let mut at = high;
        let next = |at: f64| {
            let near = at <= self.largest_knee() + NEAR && at > self.largest_knee() - NEAR;
            at - LN_10 / if near { CLOSE_PER_DECADE } else { PER_DECADE }
        };
        let mut knees = vec![at];
        while at > low {
            at = next(at).max(low);
            knees.push(at);
        }
        knees
    }

    /// The unknowns on which the sum of squares depends smoothly at `x`: all but the knee, and but the Dirac where no amplitude reaches the knee.
    pub(super) fn smooth(&self, x: &[f64]) -> Vec<usize> {
        let knee = self.chart.knee();
        let unseen = knee.is_some_and(|knee| x[knee] >= self.largest_knee());
        self.free().into_iter().filter(|j| knee != Some(*j) && !(unseen && *j == DIRAC)).collect()
    }

    /// The same problem with a further parameter held.
    pub(super) fn holding(&self, parameter: Parameter) -> Self {
        let held: Vec<Parameter> = self.held.iter().copied().chain([parameter]).collect();
        Self { chart: Chart::holding(&held, self.chart.amplitude), held, ..self.clone() }
    }

    /// Number of residuals.
    pub(super) fn count(&self) -> usize {
        2 * self.sets.iter().map(|set| set.data.len()).sum::<usize>()
            + self.ring_downs.map_or(0, Likelihood::count)
    }

    fn starts(&self) -> &[TurningPoint] {
        self.ring_downs.map_or(&[], Likelihood::starts)
    }

    fn own(&self) -> usize {
        OTHERS + 1 + self.sets.len()
    }

    /// Number of unknowns, held ones included.
    fn unknowns(&self) -> usize {
        self.own() + OWN * self.starts().len()
    }

    /// The unknowns that are sought. Without ring-downs the first measurement sets the frequency and has no drift; the others drift from there.
    pub(super) fn free(&self) -> Vec<usize> {
        let first_drifts = self.ring_downs.is_some();
        let is_free = |j: &usize| match *j {
            j if j < COUNT => self.held.iter().all(|h| self.chart.index(*h) != Some(j)),
            OTHERS => self.responses,
            j if j == OTHERS + 1 => first_drifts,
            _ => true,
        };
        (0..self.unknowns()).filter(is_free).collect()
    }

    pub(super) fn bounds(&self) -> Vec<(f64, f64)> {
        let drift = MOST_DRIFT / DRIFT_UNIT;
        let days = vec![(-drift, drift); self.sets.len()];
        let own = [(-3.0, 3.0), (-FRAC_PI_2, FRAC_PI_2)];
        let others = [(f64::NEG_INFINITY, f64::INFINITY)];
        let starts = self.starts().iter().flat_map(|_| own);
        let mut chart = Chart::bounds();
        if let Some(knee) = self.chart.knee() {
            chart[knee].0 = self.least_knee;
        }
        chart.into_iter().chain(others).chain(days).chain(starts).collect()
    }

    pub(super) fn coordinates(&self, p: &Parameters) -> Result<Vec<f64>, Error> {
        let mut x = self.chart.coordinates(p)?.to_vec();
        x.resize(self.unknowns(), 0.0);
        Ok(x)
    }

    /// Coordinates of this problem for coordinates `x` of another one.
    pub(super) fn carried(&self, other: &Task<'_>, x: &[f64]) -> Result<Vec<f64>, Error> {
        let mut own = self.coordinates(&other.chart.parameters(x))?;
        own[COUNT..].copy_from_slice(&x[COUNT..]);
        Ok(own)
    }

    /// Static flexibility of all other modes at the measured point.
    pub(super) fn others(&self, x: &[f64]) -> f64 {
        x[OTHERS] / self.unit
    }

    /// Relative drift of each measurement's frequency.
    pub(super) fn drifts(&self, x: &[f64]) -> Vec<f64> {
        x[OTHERS + 1..self.own()].iter().map(|d| DRIFT_UNIT * d).collect()
    }

    /// The mode on the day of each measurement.
    pub(super) fn modes(&self, x: &[f64]) -> Result<Vec<DayMode>, Error> {
        let p = self.chart.parameters(x);
        let others = self.others(x);
        self.drifts(x).into_iter().map(|drift| DayMode::new(&p, others, drift)).collect()
    }

    /// Residuals in standard deviations; false where the model does not exist at `x`.
    pub(super) fn residuals(&self, x: &[f64], out: &mut [f64], buffers: &mut Buffers) -> bool {
        if !self.chart.leaves_residual_stiffness(x) {
            return false;
        }
        let Ok(modes) = self.modes(x) else { return false };
        let mut at = 0;
        for (set, mode) in self.sets.iter().zip(&modes) {
            let end = at + 2 * set.data.len();
            if !set.residuals(mode, &mut out[at..end]) {
                return false;
            }
            at = end;
        }
        let Some(ring_downs) = self.ring_downs else { return true };
        let p = self.chart.parameters(x);
        let radian = 1.0 / (TAU * p.frequency);
        let moved = self.starts().iter().zip(x[self.own()..].chunks_exact(OWN));
        let starts: Vec<TurningPoint> = moved
            .map(|(start, own)| TurningPoint {
                displacement: start.displacement * own[0].exp(),
                time: start.time + own[1] * radian,
                day: start.day,
            })
            .collect();
        ring_downs.residuals(&p, &starts, &mut out[at..], buffers)
    }

    /// The least sum of squares from `x` over the unknowns in `free`.
    pub(super) fn minimise(
        &self,
        x: &[f64],
        free: Vec<usize>,
        tolerance: f64,
        iterations: usize,
    ) -> Option<Minimum> {
        let mut buffers = Buffers::default();
        let search = Search::new(self.count(), free, self.bounds(), (iterations, tolerance));
        search.run(&mut |x: &[f64], out: &mut [f64]| self.residuals(x, out, &mut buffers), x)
    }

    /// Sum of the logarithms of all errors, one for each value. Valleys (local minima) are compared by it as well, since errors are
    /// estimated in each of them and the sum of squares alone does not tell them apart.
    pub(super) fn spread(&self) -> f64 {
        self.sets.iter().map(|set| set.data.len() as f64 * set.errors.map(f64::ln).iter().sum::<f64>()).sum()
    }

    /// Sets weights and errors of all measurements from the model at `x`; the freedom that the unknowns take is spread evenly over all residuals.
    pub(super) fn weigh(&mut self, x: &[f64]) -> Result<(), Error> {
        let modes = self.modes(x)?;
        let share = self.free().len() as f64 / self.count() as f64;
        for (set, mode) in self.sets.iter_mut().zip(&modes) {
            set.weigh(mode, share);
        }
        Ok(())
    }
}

impl Weighted<'_> {
    fn residuals(&self, mode: &DayMode, out: &mut [f64]) -> bool {
        match self.data {
            SteadyData::Response(points) => {
                for ((point, factor), out) in points.iter().zip(&self.factors).zip(out.chunks_exact_mut(2)) {
                    let left = mode.unbalanced(point);
                    let white = factor * Vector2::new(left.re, left.im) / self.errors[0];
                    (out[0], out[1]) = (white[0], white[1]);
                }
                true
            }
            SteadyData::Backbone(points) => {
                for (point, out) in points.iter().zip(out.chunks_exact_mut(2)) {
                    let Some([frequency, damping]) = mode.free(point.amplitude) else { return false };
                    out[0] = (frequency / point.frequency).ln() / self.errors[0];
                    out[1] = (damping / point.damping_ratio).ln() / self.errors[1];
                }
                true
            }
        }
    }

    fn weigh(&mut self, mode: &DayMode, share: f64) {
        if let SteadyData::Response(points) = self.data {
            let factor = |point| {
                let [by_size, by_phase] = mode.sensitivities(point);
                factor([by_size, by_phase].map(|s| Vector2::new(s.re, s.im)), point.force)
            };
            let old = std::mem::take(&mut self.factors);
            self.factors = points.iter().zip(old).map(|(p, old)| factor(p).unwrap_or(old)).collect();
        }
        let mut out = vec![0.0; 2 * self.data.len()];
        if !self.residuals(mode, &mut out) {
            return;
        }
        let freedom = (self.data.len() as f64 * (1.0 - share)).max(1.0);
        let square = |which: usize| out.iter().skip(which).step_by(2).map(|r| r * r).sum::<f64>();
        let times = match self.data {
            SteadyData::Response(_) => [((square(0) + square(1)) / (2.0 * freedom)).sqrt(); 2],
            SteadyData::Backbone(_) => [0, 1].map(|which| (square(which) / freedom).sqrt()),
        };
        for (error, times) in self.errors.iter_mut().zip(times) {
            *error = (*error * times).max(LEAST_ERROR);
        }
    }
}

/// Errors before there is a model. For a backbone: a fraction of its range of frequency (in logarithms), and that fraction of the damping.
fn first_errors(data: &SteadyData) -> [f64; 2] {
    /// A twentieth of either is enough to tell valleys (local minima) apart; the errors themselves are estimated afterwards.
    const PART: f64 = 0.05;
    let SteadyData::Backbone(points) = data else { return [PART; 2] };
    let logs = || points.iter().map(|p| p.frequency.ln());
    let range = logs().fold(f64::NEG_INFINITY, f64::max) - logs().fold(f64::INFINITY, f64::min);
    [(PART * range).max(LEAST_ERROR), PART]
}

/// Weights before there is a model: the force stands for the effect of all three errors.
fn first_factors(data: &SteadyData) -> Vec<Matrix2<f64>> {
    let SteadyData::Response(points) = data else { return Vec::new() };
    points.iter().map(|point| Matrix2::identity() / (std::f64::consts::SQRT_2 * point.force)).collect()
}

/// The inverse Cholesky factor of the covariance of the unbalanced force for relative errors of size one in amplitude, phase and force.
fn factor([by_size, by_phase]: [Vector2<f64>; 2], force: f64) -> Option<Matrix2<f64>> {
    let covariance = by_size * by_size.transpose()
        + by_phase * by_phase.transpose()
        + Matrix2::identity() * (force * force);
    Cholesky::new(covariance)?.l().try_inverse()
}
