//! The records in the form that searches work on: unknowns with their bounds, weights, and computed models that evaluations have in common.

use std::collections::VecDeque;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use iwan_machine::checkpoint::Checkpoint;
use iwan_machine::threads::{at_once, in_parallel};
use rustfft::num_complex::Complex64;
use serde::{Deserialize, Serialize};

use super::amplitudes::days;
use super::amplitudes::slow::{Buffers, KEPT};
use super::amplitudes::windows::Windows;
use super::discount::Discount;
use super::record::{Noise, Windowed};
use super::release::{Sampling, TurningPoint};
use super::ring_down::{Discrepancy, Refined, RingDown};
use crate::error::{Error, check};
use crate::parameters::{COUNT, Parameter, Parameters};
use crate::search::{Chart, FREQUENCY, Kept, Minimum, Search, Sooner};

/// Unknowns of each record: ln of the first amplitude over its guess, phase of the release, and ln of the record's own frequency, where the first coordinate of the mode is taken,
/// over that of its windows. The third is not the day's frequency over the mean: a record tells its own frequency, and a mean that moves with all
/// days is a long way for a search.
pub(super) const OWN: usize = 3;
/// Bound, to either side, of ln of a record's own frequency over that of its windows: a joint that softens by a third hides as much of the frequency
/// at rest.
const OWN_FREQUENCY: f64 = 0.5;
/// Bound, to either side, of ln of the mode's frequency over that of the windows: a factor of four, twice what a joint of three
/// times the residual stiffness can hide. An interval of the frequency that reaches it is open. Without it the walk along the frequency of a record that
/// no joint tells went on to a thousand times the frequency, where a ring-down has a thousand times as many half cycles: the fit took seventeen times as long.
const FARTHEST_FREQUENCY: f64 = 1.4;
/// Place of that frequency among the unknowns of a record.
pub(super) const DAY: usize = 2;
/// Relative reduction of the sum of squares at which all searches but the last end: enough to tell which valley (local minimum along the knee) is the
/// deepest.
pub(super) const ROUGH: f64 = 1e-4;
/// Relative reduction of the sum of squares at which searches for a minimum under noise end: of some 200 residuals it moves the deviance by 4e-4, a
/// ten-thousandth of the limit.
pub(super) const FINE: f64 = 2e-6;
/// Residuals that are needed beyond the number of unknowns; records with fewer are refused. With three the residuals' variance is known to a factor
/// of three at least.
const SPARE: usize = 3;
/// Relative reduction at which a scan's searches end, and their most iterations: from a neighbouring knee one or two steps are enough, and only the
/// shape of the valleys counts. Searches that find the deepest valley go on from there.
const SCAN: f64 = 0.03;
const SCAN_ITERATIONS: usize = 4;
/// Most iterations of a rough search; a later search goes on from where it stands.
const ROUGH_ITERATIONS: usize = 30;
/// Most iterations of a fine search; when they are spent the result says that it has not converged.
const FINE_ITERATIONS: usize = 100;

/// Number of the record whose own unknown this is; none for a parameter that all records share.
pub(super) fn record_of(unknown: usize) -> Option<usize> {
    unknown.checked_sub(COUNT).map(|own| own / OWN)
}

/// The records in the form that the searches work on.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Task {
    pub(crate) chart: Chart,
    pub(super) records: Vec<Windowed>,
    pub(super) held: Vec<Parameter>,
    /// The discount for what the model is known to miss; none where nothing is known.
    pub(super) discount: Option<Discount>,
    pub(super) discrepancy: Discrepancy,
    /// Standard deviation of the days' ln frequencies that is taken for granted; where records have days, each has a residual that holds its day to
    /// it.
    pub(super) day_deviation: f64,
    /// Whether records may differ by the day.
    strays: bool,
    /// Whether the discount allows for what a clean record cannot show.
    pub(crate) widened: bool,
    /// Whether residuals are logarithms of the ratio of record to model, times the record: in these logarithms, what the model misses adds up however
    /// far apart the phases are.
    pub(super) by_logarithms: bool,
    /// Once set there are no residuals any more, so that every search ends.
    #[serde(skip)]
    pub(crate) stopped: Arc<AtomicBool>,
    /// The checkpoint in which ends of searches are kept; none: they are not kept.
    #[serde(skip)]
    pub(crate) kept: Option<Arc<Checkpoint>>,
}

/// Buffers that all evaluations of a search share.
#[derive(Debug, Clone, Default)]
pub(crate) struct Workspace {
    buffers: Buffers,
    pub(super) model: Vec<Complex64>,
    /// The models computed last, one list per record: a record's own unknowns change no other record.
    known: Vec<VecDeque<Known>>,
    /// A second workspace, for work at the same time.
    pub(super) aside: Option<Box<Self>>,
}

/// A model's amplitudes in the windows of a record.
#[derive(Debug, Clone)]
struct Known {
    parameters: Parameters,
    start: TurningPoint,
    windows: Windows,
    model: Vec<Complex64>,
}

impl Workspace {
    /// Puts the model of record number `place` into `model`, computed or from the known ones; false where there is none.
    pub(super) fn compute(
        &mut self,
        place: usize,
        parameters: &Parameters,
        start: TurningPoint,
        record: &Windowed,
    ) -> bool {
        self.known.resize_with(self.known.len().max(place + 1), VecDeque::new);
        let same = |k: &Known| (&k.parameters, k.start, k.windows) == (parameters, start, record.windows);
        if let Some(found) = self.known[place].iter().find(|k| same(k)) {
            self.model.clone_from(&found.model);
            return true;
        }
        let windows = record.windows;
        self.model.resize(windows.count, Complex64::default());
        if !windows.of_model(parameters, start, record.quantity, &mut self.buffers, &mut self.model) {
            return false;
        }
        let known = &mut self.known[place];
        // The oldest known model makes room, and lends its buffer.
        let mut model =
            if known.len() < KEPT { Vec::new() } else { known.pop_front().map_or(Vec::new(), |k| k.model) };
        model.clone_from(&self.model);
        known.push_back(Known { parameters: *parameters, start, windows: record.windows, model });
        true
    }
}

/// How long a search goes on.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Effort {
    /// Most iterations.
    pub(crate) iterations: usize,
    /// Relative reduction of the sum of squares at which the search ends.
    pub(crate) tolerance: f64,
    /// Where the search ends sooner.
    pub(crate) sooner: Option<Sooner>,
    /// Whether derivatives are central whatever the tolerance.
    pub(crate) central: bool,
}

impl Effort {
    /// The effort of derivatives alone, without a step.
    pub(crate) const NONE: Self = Self { iterations: 0, tolerance: 0.0, sooner: None, central: false };
    /// The effort of scans, whose points each go on from a neighbour.
    pub(super) const SCAN: Self =
        Self { iterations: SCAN_ITERATIONS, tolerance: SCAN, sooner: None, central: false };
    /// The effort of searches that are not the last.
    pub(super) const ROUGH: Self =
        Self { iterations: ROUGH_ITERATIONS, tolerance: ROUGH, sooner: None, central: false };

    /// A search that ends when an iteration brings less than the relative `tolerance`, with as many iterations as this needs.
    pub(crate) fn until(tolerance: f64) -> Self {
        let iterations = if tolerance > FINE { ROUGH_ITERATIONS } else { FINE_ITERATIONS };
        Self { iterations, tolerance, sooner: None, central: false }
    }

    /// The effort of sweeps: that of scans above a sum of squares, and until the relative `tolerance` below.
    pub(super) fn of_sweeps(above: f64, tolerance: f64) -> Self {
        let sooner = Some(Sooner { above, iterations: SCAN_ITERATIONS, tolerance: SCAN });
        Self { sooner, ..Self::until(tolerance) }
    }
}

impl Task {
    /// Checks the records; the windows refer to the frequency of `first`.
    pub(crate) fn new(
        records: &[RingDown<'_>],
        first: &Parameters,
        held: &[Parameter],
    ) -> Result<Self, Error> {
        check("records", records.len() as f64, !records.is_empty(), "at least one", "give a record")?;
        let records = records.iter().map(|r| Windowed::new(r, first)).collect::<Result<Vec<_>, _>>()?;
        let middle = |r: &Windowed| (r.start.displacement.abs().ln(), 1.0);
        let sum = records.iter().map(middle).fold((0.0, 0.0), |s, m| (s.0 + m.0, s.1 + m.1));
        let amplitude = (sum.0 / sum.1 - 1.0).exp();
        let chart = Chart::holding(held, amplitude);
        let loudness: Vec<f64> = records.iter().map(|r| r.start.displacement.abs()).collect();
        let task = Self {
            chart,
            records,
            held: held.to_vec(),
            discount: None,
            discrepancy: Discrepancy::default(),
            day_deviation: days::FIRST,
            strays: days::may_stray(&loudness),
            widened: false,
            by_logarithms: false,
            stopped: Arc::default(),
            kept: None,
        };
        let needed = COUNT + DAY * task.records.len() + SPARE;
        if task.in_windows() < needed {
            let remedy = "record longer";
            return Err(Error::TooShort {
                what: "independent amplitudes",
                found: task.in_windows(),
                needed,
                remedy,
            });
        }
        Ok(task)
    }

    /// Makes searches begin with these days (ln of frequency ratios, one per record, of mean zero); without any, records do not differ by the day.
    pub(crate) fn begin_with(&mut self, days: Option<&[f64]>) {
        self.strays = days.is_some();
        let days = days.unwrap_or_default();
        for (record, day) in self.records.iter_mut().zip(days) {
            record.start.day = *day;
        }
    }

    /// Number of residuals: those in windows, and one for the day of each of several records.
    pub(crate) fn count(&self) -> usize {
        self.in_windows() + if self.has_days() { self.records.len() } else { 0 }
    }

    /// Number of residuals in windows.
    pub(super) fn in_windows(&self) -> usize {
        self.records.iter().map(|r| 2 * r.windows.count).sum()
    }

    /// Whether records may differ by the day.
    pub(crate) fn has_days(&self) -> bool {
        self.strays
    }

    pub(crate) fn held(&self) -> &[Parameter] {
        &self.held
    }

    /// Indices of the unknowns that are sought: all but those held, and days only where records have days. The records' own come first: their columns of derivatives lie apart, so that
    /// triangular factors are made of their products.
    pub(crate) fn free(&self) -> Vec<usize> {
        let all = COUNT + OWN * self.records.len();
        let is_day = |j: usize| j >= COUNT && (j - COUNT) % OWN == DAY;
        let is_free = |j: &usize| self.held.iter().all(|h| self.chart.index(*h) != Some(*j));
        (COUNT..all).chain(0..COUNT).filter(|j| is_free(j) && (self.has_days() || !is_day(*j))).collect()
    }

    /// The unknowns without the knee: along them the sum of squares is smooth.
    pub(crate) fn smooth(&self) -> Vec<usize> {
        let knee = self.chart.knee();
        self.free().into_iter().filter(|j| knee != Some(*j)).collect()
    }

    /// Index of the knee among the coordinates, if it is sought.
    pub(crate) fn knee(&self) -> Option<usize> {
        self.chart.knee().filter(|j| self.free().contains(j))
    }

    pub(crate) fn bounds(&self) -> Vec<(f64, f64)> {
        let own = [(-3.0, 3.0), (-0.5 * PI, 0.5 * PI), (-OWN_FREQUENCY, OWN_FREQUENCY)];
        let mut shared = Chart::bounds();
        if let Some(record) = self.records.first() {
            let ln_frequency = (record.windows.omega / TAU).ln();
            shared[FREQUENCY] = (ln_frequency - FARTHEST_FREQUENCY, ln_frequency + FARTHEST_FREQUENCY);
        }
        shared.into_iter().chain(self.records.iter().flat_map(|_| own)).collect()
    }

    pub(crate) fn coordinates(&self, parameters: &Parameters) -> Result<Vec<f64>, Error> {
        let mut x = self.chart.coordinates(parameters)?.to_vec();
        for record in &self.records {
            x.extend([0.0, 0.0, record.over_windows(x[FREQUENCY])]);
        }
        Ok(x)
    }

    /// Moves the records' own frequencies in `to` by as much as the mode's frequency has moved from `from`, so that the days stay.
    pub(crate) fn keep_days(from: &[f64], to: &mut [f64]) {
        let moved = to[FREQUENCY] - from[FREQUENCY];
        to[COUNT..].iter_mut().skip(DAY).step_by(OWN).for_each(|own| *own += moved);
    }

    /// The turning point of each record.
    pub(super) fn starts_at(&self, x: &[f64]) -> Vec<TurningPoint> {
        (0..self.records.len()).map(|place| self.start_at(x, place)).collect()
    }

    /// The turning point of record number `place`.
    pub(super) fn start_at(&self, x: &[f64], place: usize) -> TurningPoint {
        let omega = TAU * self.chart.parameters(x).frequency;
        let own = &x[COUNT + OWN * place..COUNT + OWN * (place + 1)];
        self.records[place].start_at(own, (omega, x[FREQUENCY]), self.has_days())
    }

    /// A search over the coordinates in `free`.
    pub(crate) fn search(&self, free: Vec<usize>, effort: Effort) -> Search {
        let Effort { iterations, tolerance, sooner, central } = effort;
        let floor = self.count() as f64 * self.least_variance();
        let (count, bounds) = (self.count(), self.bounds());
        let kept = self.kept.clone().map(|checkpoint| Kept { checkpoint, stopped: self.stopped.clone() });
        Search { sooner, central, floor, kept, ..Search::new(count, free, bounds, (iterations, tolerance)) }
    }

    /// Takes what sampling adds to the model's amplitudes from the ring-down at `x`: harmonics that fold back where a cycle has few samples, and the
    /// difference between a sum over samples and an integral.
    pub(crate) fn take_samples(&mut self, x: &[f64], work: &mut Workspace) {
        let (parameters, starts) = (self.chart.parameters(x), self.starts_at(x));
        let begun: Vec<(&Windowed, TurningPoint)> =
            self.records.iter().zip(starts.into_iter().map(TurningPoint::on_mean_day)).collect();
        let sampled = in_parallel(&begun, at_once(), &|(record, start)| {
            let sampling = Sampling { dt: record.dt, count: record.samples };
            let samples = start.samples(&parameters, sampling, record.quantity);
            samples.map(|samples| record.windows.of_samples(&samples, record.dt))
        });
        let exact: Vec<Option<Vec<Complex64>>> = begun
            .iter()
            .map(|(record, start)| {
                let (windows, buffers) = (&record.windows, &mut work.buffers);
                let mut exact = vec![Complex64::default(); windows.count];
                windows.of_model(&parameters, *start, record.quantity, buffers, &mut exact).then_some(exact)
            })
            .collect();
        for (record, found) in self.records.iter_mut().zip(sampled.into_iter().zip(exact)) {
            if let (Ok(sampled), Some(exact)) = found {
                record.sampling = sampled.iter().zip(&exact).map(|(a, b)| a - b).collect();
            }
        }
    }

    /// Sets each record's noise to that of its residuals at `x`, the same for all windows. Where a discount is in force the noise stays, because it
    /// was estimated together with what the model misses.
    pub(super) fn weigh(&mut self, x: &[f64], work: &mut Workspace) {
        let mut out = vec![0.0; self.count()];
        if self.discount.is_some() {
            return;
        }
        self.forget_parts();
        if !self.residuals(x, &mut out, work) {
            return;
        }
        let unknowns = self.free().len() as f64 / self.records.len() as f64;
        let mut from = 0;
        for record in &mut self.records {
            let n = 2 * record.windows.count;
            let square: f64 = out[from..from + n].iter().map(|r| r * r).sum();
            let deviation = record.noise.floor * (square / (n as f64 - unknowns).max(1.0)).sqrt();
            record.take_noise(Noise { floor: deviation.max(record.floor()), part: 0.0 });
            from += n;
        }
    }

    /// Makes the noise the same in all windows: the part that grows with the amplitude becomes zero.
    pub(super) fn forget_parts(&mut self) {
        for record in &mut self.records {
            record.take_noise(Noise { part: 0.0, ..record.noise });
        }
    }

    /// Variance of the residuals that the forward model itself accounts for.
    pub(crate) fn least_variance(&self) -> f64 {
        let floor = |r: &Windowed| (r.floor() / r.noise.floor).powi(2);
        self.records.iter().map(floor).fold(0.0, f64::max)
    }

    /// Whether standard deviations are known beside those that residuals show, because other modes were subtracted.
    pub(crate) fn is_beside_others(&self) -> bool {
        self.records.iter().any(Windowed::is_beside_others)
    }

    pub(crate) fn refined(&self, minimum: &Minimum) -> Refined {
        let mut work = Workspace::default();
        let (mut out, mut plain) = (vec![0.0; self.count()], vec![0.0; self.count()]);
        self.residuals(&minimum.x, &mut out, &mut work);
        let parameters = self.chart.parameters(&minimum.x);
        self.plain_residuals(&parameters, &self.starts_at(&minimum.x), &mut plain, &mut work);
        let (mut noise, mut square, mut total, mut product, mut from) = (vec![], 0.0, 0.0, 0.0, 0);
        for record in &self.records {
            let n = 2 * record.windows.count;
            let part = &out[from..from + n];
            let sum = |part: &[f64]| part.iter().map(|r| r * r).sum::<f64>();
            // The density of the noise in each quadrature is half the variance of a sample times dt.
            noise.push(record.noise.floor * (sum(part) / n as f64).sqrt() * (2.0 / record.dt).sqrt());
            let left = plain[from..from + n].chunks_exact(2).zip(&record.deviations);
            square += left.map(|(r, deviation)| sum(r) * deviation.powi(2)).sum::<f64>();
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
            discrepancy: self.discrepancy,
            converged: minimum.converged,
        }
        .without_rounding()
    }
}

pub(super) fn no_ring_down() -> Error {
    let finding = "the start values have no ring-down".into();
    Error::Refused {
        finding,
        remedy: "narrow the band to the mode, cut the records to their decays, or fit them one by one",
    }
}
