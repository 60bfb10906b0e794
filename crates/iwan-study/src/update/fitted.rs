//! The unknowns that describe the curves best, with intervals.

use iwan_ident::estimate::{About, Found, Interval, Model, Told, Weights, intervals, least, silent};
use serde::Serialize;

use super::model::{Beside, DAMPING_UNIT, law};
use crate::error::Error;

/// Rounds in which the standard deviations of the curves are computed from their residuals; after the third they change by no more than a hundredth.
const ROUNDS: usize = 4;
/// Smallest relative standard deviation of a damping ratio and of a frequency: the error of quasi-static curves of a reduced structure. A judgement:
/// the reduced model's curves are within 2e-3 of the structure's in dissipation, and within 1e-3 of the softening of the frequency.
pub(super) const LEAST_DAMPING: f64 = 1e-3;
pub(super) const LEAST_FREQUENCY: f64 = 1e-6;
/// The standard deviation of a curve is at least the mean of its kind divided by this, however small its residuals are: an unknown that adapts to one
/// curve alone would make this curve look perfect.
const MOST_BELIEVED: f64 = 10.0;
/// Most times that the search is begun anew because the walk along an interval (one unknown is moved step by step while the others are fitted) met a
/// better point.
const MOST_ANEW: usize = 3;

/// Half width of a 95 % interval in standard deviations of a normal distribution.
pub(super) const NORMAL: f64 = 1.96;
/// Increase of the sum of squares, in units of the variance, at which a 95 % interval ends: the 95 % point of chi-square with one degree of freedom.
pub(super) const ENDS: f64 = NORMAL * NORMAL;

/// A value with its 95 % interval; null is an open end.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Estimated {
    /// The best value.
    pub value: f64,
    /// Lower end.
    pub low: Option<f64>,
    /// Upper end.
    pub high: Option<f64>,
    /// Whether the data bound the value on both sides.
    pub identifiable: bool,
}

/// A group of joints with the parameters found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointUpdate {
    /// Name of the group.
    pub name: String,
    /// Names of its joints.
    pub joints: Vec<String>,
    /// Joint stiffness K_T of each joint.
    pub k_t: Estimated,
    /// Slip force F_S.
    pub f_s: Estimated,
    /// Power χ.
    pub chi: Estimated,
    /// Ratio β.
    pub beta: Estimated,
    /// Largest slip in the curves over φ_max: from 1 on the curves contain macro-slip.
    pub slip_ratio: f64,
}

/// The best unknowns of a fit, with the standard deviations found on the way.
#[derive(Debug, Clone)]
pub(super) struct Fit<'a> {
    pub(super) model: Beside<'a>,
    pub(super) found: Found,
    pub(super) free: Vec<usize>,
    /// Variance of the residuals, inflated where neighbouring residuals are correlated.
    pub(super) variance: f64,
    pub(super) told: Told,
}

impl<'a> Fit<'a> {
    /// Fits from several starts. Unknowns to which the curves are insensitive keep the values of the first start.
    pub(super) fn new(mut model: Beside<'a>, starts: &[Vec<f64>]) -> Result<Self, Error> {
        let failed = Error::identification("update");
        let unfelt = |model: &Beside<'_>, x: &[f64]| silent(model, x, 1.0).map_err(&failed);
        let mut held = unfelt(&model, &starts[0])?;
        let free = |held: &[usize]| (0..starts[0].len()).filter(|j| !held.contains(j)).collect::<Vec<_>>();
        let starts: Vec<Vec<f64>> = starts.iter().map(|x| holding(x, &starts[0], &held)).collect();
        let mut found = least(&model, &starts, &free(&held)).map_err(&failed)?;
        for _ in 0..ROUNDS {
            let weights = weights_of(&model, &found.x, free(&held).len());
            reweighted(&mut model, &weights);
            // Unknowns to which the curves are sensitive at the point found are sought from now on.
            let still = unfelt(&model, &found.x)?;
            held.retain(|j| still.contains(j));
            found = least(&model, std::slice::from_ref(&found.x), &free(&held)).map_err(&failed)?;
        }
        let free = free(&held);
        Self::about(model, found, free)
    }

    /// Makes the fit from unknowns that are found already.
    fn about(model: Beside<'a>, found: Found, free: Vec<usize>) -> Result<Self, Error> {
        let weights = weights_of(&model, &found.x, free.len());
        let freedom = (model.count() as f64 - free.len() as f64).max(1.0);
        // The assumed standard deviations hold at least the curves' own error; a sum of squares that is smaller by chance does not reduce the
        // variance below half.
        let variance = weights.inflation * (found.cost / freedom).max(0.5);
        let told = Told::about(&model, &found, &free, variance).map_err(Error::identification("update"))?;
        Ok(Self { model, found, free, variance, told })
    }

    /// Intervals of all unknowns in their coordinates; the fit moves to a better point where a walk along an interval meets one.
    pub(super) fn intervals(&mut self, threads: usize) -> Result<Vec<Interval>, Error> {
        for round in 0..=MOST_ANEW {
            match self.intervals_here(threads, round == MOST_ANEW) {
                Ok(all) => return Ok(all),
                Err(better) => {
                    let failed = Error::identification("update");
                    let found = least(&self.model, &[better.x], &self.free).map_err(failed)?;
                    *self = Self::about(self.model.clone(), found, self.free.clone())?;
                }
            }
        }
        Ok(vec![Interval::default(); self.model.bounds.len()])
    }

    fn intervals_here(&self, threads: usize, settled: bool) -> Result<Vec<Interval>, Found> {
        let about = About { found: &self.found, free: &self.free, variance: self.variance, settled };
        let all: Vec<usize> = (0..self.model.bounds.len()).collect();
        intervals(&self.model, about, &all, threads)
    }

    /// The parameters of a group of joints with their intervals.
    pub(super) fn joint(&self, group: usize, intervals: &[Interval], slip_ratio: f64) -> JointUpdate {
        let of = |k: usize, value: &dyn Fn(f64) -> f64| {
            estimated(self.found.x[4 * group + k], intervals[4 * group + k], value)
        };
        let beta = |x: f64| x / (1.0 - x);
        JointUpdate {
            name: String::new(),
            joints: Vec::new(),
            k_t: of(0, &f64::exp),
            f_s: of(1, &f64::exp),
            chi: of(2, &|x| x),
            beta: of(3, &beta),
            slip_ratio,
        }
    }

    /// The viscous damping ratio of a measured mode.
    pub(super) fn viscous(&self, mode: usize, intervals: &[Interval]) -> Estimated {
        let place = self.model.first_viscous() + mode;
        estimated(self.found.x[place], intervals[place], &|x| DAMPING_UNIT * x)
    }

    /// The factor on a part of the stiffness.
    pub(super) fn factor(&self, number: usize, intervals: &[Interval]) -> Estimated {
        let place = self.model.first_factor() + number;
        estimated(self.found.x[place], intervals[place], &f64::exp)
    }

    /// The laws that were found, group by group.
    pub(super) fn laws(&self) -> Vec<iwan_core::FourParameter> {
        self.found.x[..self.model.first_factor()].chunks_exact(4).filter_map(law).collect()
    }
}

/// A start in which the held unknowns have the values of the first start.
pub(super) fn holding(x: &[f64], first: &[f64], held: &[usize]) -> Vec<f64> {
    x.iter()
        .zip(first)
        .enumerate()
        .map(|(j, (x, first))| if held.contains(&j) { *first } else { *x })
        .collect()
}

pub(super) fn estimated(x: f64, interval: Interval, value: &dyn Fn(f64) -> f64) -> Estimated {
    let (low, high) = (interval.low.map(value), interval.high.map(value));
    Estimated { value: value(x), low, high, identifiable: low.is_some() && high.is_some() }
}

fn weights_of(model: &Beside<'_>, x: &[f64], unknowns: usize) -> Weights {
    let mut residuals = vec![0.0; model.count()];
    model.evaluate(x, &mut residuals, None);
    Weights::of(&residuals, &model.series(), unknowns)
}

/// Sets the standard deviations of each curve from its residuals.
fn reweighted(model: &mut Beside<'_>, weights: &Weights) {
    let square = |values: Vec<f64>| (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt();
    let mut all: Vec<(f64, f64)> = Vec::new();
    for (curve, found) in model.curves.iter().zip(weights.deviations.chunks_exact(2)) {
        all.push((curve.frequency_sd * found[0] / mean_frequency(curve), curve.damping_sd * found[1]));
    }
    let mean = (square(all.iter().map(|a| a.0).collect()), square(all.iter().map(|a| a.1).collect()));
    for (curve, (frequency, damping)) in model.curves.iter_mut().zip(all) {
        let relative = frequency.max(mean.0 / MOST_BELIEVED).max(LEAST_FREQUENCY);
        curve.frequency_sd = relative * mean_frequency(curve);
        curve.damping_sd = damping.max(mean.1 / MOST_BELIEVED).max(LEAST_DAMPING);
    }
}

pub(super) fn mean_frequency(curve: &super::model::Curve) -> f64 {
    curve.points.iter().map(|p| p.frequency).sum::<f64>() / curve.points.len() as f64
}
