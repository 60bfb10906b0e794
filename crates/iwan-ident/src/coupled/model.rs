//! Residuals of all records for a set of unknowns, and their derivatives.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use iwan_core::Sliders;
use iwan_machine::threads::in_parallel;

use super::motion::{Clock, Motions, Sums, at_samples, populations, room, run, run_with};
use super::unknowns::{Form, Unknown, Values};
use crate::curves::Quantity;
use crate::estimate::Model;

/// Step of the one-sided differences of whole runs, in coordinates of order one. A run is smooth except for creases of the size of a slider's share,
/// and the step must reach across these; curvature makes derivatives wrong by about as much as the step.
const STEP: f64 = 3e-4;
/// Relative standard deviation that the first searches assume: about the misfit of a good modal model.
pub(super) const FIRST: f64 = 0.01;

/// A record, ready to be compared.
#[derive(Debug, Clone)]
pub(super) struct Prepared {
    pub(super) clock: Clock,
    pub(super) motions: Vec<Vec<f64>>,
}

/// Entries (see `series`) of one measured series of one record.
#[derive(Debug, Clone)]
pub(super) struct Series {
    pub(super) record: usize,
    pub(super) motion: usize,
    /// The mode that the series belongs to, where it belongs to one.
    pub(super) mode: usize,
    pub(super) sums: Sums,
    /// Standard deviation of an entry.
    pub(super) deviation: f64,
    /// Root mean square of the measured entries over the whole record.
    pub(super) size: f64,
    measured: Vec<f64>,
    /// What the model's entries are compared with: the measured entries, less the change that infinitely fine steps would make in the model's.
    sought: Vec<f64>,
    entries: Range<usize>,
    /// Root mean square of that change; 0 as long as it is not known.
    pub(super) stepping: f64,
}

/// The model of modes that share joints, together with the records that it is compared with.
#[derive(Debug, Clone)]
pub(super) struct CoupledModel<'a> {
    pub(super) form: Form,
    pub(super) records: &'a [Prepared],
    pub(super) series: Vec<Series>,
    pub(super) quantity: Quantity,
    pub(super) threads: usize,
    pub(super) stopped: &'a AtomicBool,
    /// Number of samples of each record that are compared.
    samples: Vec<usize>,
    bounds: Vec<(f64, f64)>,
}

/// How a series is made: indices of record, motion and mode, and the sums.
pub(super) type Plan = (usize, usize, usize, Sums);

impl<'a> CoupledModel<'a> {
    /// The model compared with the whole of all records.
    pub(super) fn new(
        form: Form,
        records: &'a [Prepared],
        plans: Vec<Plan>,
        quantity: Quantity,
        (threads, stopped): (usize, &'a AtomicBool),
    ) -> Self {
        let series = plans.into_iter().map(|(record, motion, mode, sums)| {
            let samples = &records[record].motions[motion];
            let mut measured = vec![0.0; sums.count(samples.len())];
            sums.apply(samples, &mut measured);
            let size = root_mean_square(&measured);
            Series {
                record,
                motion,
                mode,
                sums,
                deviation: FIRST * size,
                size,
                sought: measured.clone(),
                measured,
                entries: 0..0,
                stepping: 0.0,
            }
        });
        let series = series.filter(|series| series.size > 0.0).collect();
        let bounds = form.bounds();
        let mut model =
            Self { form, records, series, quantity, threads, stopped, samples: Vec::new(), bounds };
        model.take(1.0);
        model
    }

    /// Compares the first `share` of each record only, but never less than one window.
    pub(super) fn take(&mut self, share: f64) {
        let least = |k: usize| {
            let of = self.series.iter().filter(|s| s.record == k).map(|s| match s.sums {
                Sums::Blocks(block) => 16 * block,
                Sums::Windows { length, .. } => 2 * length,
            });
            of.max().unwrap_or(1)
        };
        let samples = |k: usize| {
            let all = self.records[k].motions[0].len();
            ((share * all as f64) as usize).clamp(least(k).min(all), all)
        };
        self.samples = (0..self.records.len()).map(samples).collect();
        let mut first = 0;
        for series in &mut self.series {
            let count = series.sums.count(self.samples[series.record]);
            series.entries = first..first + count;
            first += count;
        }
    }

    /// Range of residuals of each series.
    pub(super) fn ranges(&self) -> Vec<Range<usize>> {
        self.series.iter().map(|s| s.entries.clone()).collect()
    }

    /// Entries of all series of record `k` as the model makes them, each over its standard deviation.
    fn entries(&self, values: &Values, k: usize, motions: Motions) -> Vec<Vec<f64>> {
        let every = motions.every;
        let rows = self.at_sensors(values, k, motions);
        let of = |series: &Series| {
            let mut out = vec![0.0; series.entries.len()];
            series.sums.of_rows((&rows[series.motion], every), self.samples[k], &mut out);
            for x in &mut out {
                *x /= series.deviation;
            }
            out
        };
        self.series.iter().filter(|s| s.record == k).map(of).collect()
    }

    /// What the sensors of record `k` would show: one series of samples for each motion.
    pub(super) fn motions(&self, values: &Values, k: usize) -> Option<Vec<Vec<f64>>> {
        let motions = self.run(values, k, &self.records[k].clock)?;
        let every = motions.every;
        let rows = self.at_sensors(values, k, motions);
        Some(rows.iter().map(|rows| at_samples(rows, every, self.samples[k])).collect())
    }

    fn run(&self, values: &Values, k: usize, clock: &Clock) -> Option<Motions> {
        run((self.form.sharing, values), k, clock, self.samples[k], self.quantity)
    }

    /// What the sensors of record `k` would show, in the same rows as the motions of the modes.
    fn at_sensors(&self, values: &Values, k: usize, motions: Motions) -> Vec<Vec<f64>> {
        let motions = motions.modes;
        if self.records[k].motions.len() == motions.len() {
            return motions;
        }
        let mut sum = vec![0.0; motions[0].len()];
        for (motion, shape) in motions.iter().zip(&values.shape_at_sensor) {
            sum.iter_mut().zip(motion).for_each(|(sum, q)| *sum += shape * q);
        }
        vec![sum]
    }

    /// Largest slip over φ_max: `[record][joint]`.
    pub(super) fn slip_ratios(&self, x: &[f64]) -> Option<Vec<Vec<f64>>> {
        let values = self.form.values(x)?;
        let one = |k: usize| self.run(&values, k, &self.records[k].clock).map(|m| m.slip_ratios);
        (0..self.records.len()).map(one).collect()
    }

    /// Subtracts from the measured entries the change that infinitely fine steps would make in the model's entries at `x` (deferred correction): a search then ends where it
    /// would with such steps, at the cost of the coarse ones. The change is found with the finer `clocks` and extrapolated, because the error of a step goes with its square
    /// (L. F. Richardson). False where there is no model.
    pub(super) fn correct(&mut self, x: &[f64], clocks: &[Clock]) -> bool {
        let Some(values) = self.form.values(x) else { return false };
        let jobs: Vec<(usize, &Clock)> = clocks
            .iter()
            .enumerate()
            .flat_map(|(k, fine)| [(k, fine), (k, &self.records[k].clock)])
            .collect();
        let work =
            |(k, clock): &(usize, &Clock)| Some(self.entries(&values, *k, self.run(&values, *k, clock)?));
        let found = in_parallel(&jobs, self.threads, &work);
        let Some(found) = found.into_iter().collect::<Option<Vec<_>>>() else { return false };
        for (k, pair) in found.chunks_exact(2).enumerate() {
            let square = (self.records[k].clock.step / clocks[k].step).powi(2);
            let extrapolated = square / (square - 1.0);
            for (series, (fine, own)) in
                self.series.iter_mut().filter(|s| s.record == k).zip(pair[0].iter().zip(&pair[1]))
            {
                let unit = extrapolated * series.deviation;
                let change: Vec<f64> = fine.iter().zip(own).map(|(fine, own)| unit * (fine - own)).collect();
                let sought = series.measured.iter().zip(&change).map(|(measured, change)| measured - change);
                series.sought = sought.collect();
                series.stepping = root_mean_square(&change);
            }
        }
        true
    }

    /// Whether [`correct`](Self::correct) has found the error of the steps.
    pub(super) fn is_corrected(&self) -> bool {
        self.series.iter().any(|series| series.stepping > 0.0)
    }

    /// Indices of the residuals of record `k`.
    pub(super) fn rows_of(&self, k: usize) -> impl Iterator<Item = usize> + '_ {
        self.series.iter().filter(move |s| s.record == k).flat_map(|s| s.entries.clone())
    }

    /// Changes of the residuals of record `k`, with their indices, when its load at the steps is replaced by `load`; none where there is no model.
    pub(super) fn changes_by_load(&self, x: &[f64], k: usize, load: Vec<f64>) -> Option<Vec<(usize, f64)>> {
        let values = self.form.values(x)?;
        let own = &self.records[k].clock;
        let of = |clock: &Clock| Some(self.entries(&values, k, self.run(&values, k, clock)?).concat());
        let (before, after) = (of(own)?, of(&own.with_load(load))?);
        Some(self.rows_of(k).zip(after.iter().zip(before).map(|(a, b)| a - b)).collect())
    }

    /// Whether an unknown has an effect on record `k`.
    fn matters(unknown: Unknown, k: usize) -> bool {
        match unknown {
            Unknown::Displacement(own, _) | Unknown::Velocity(own, _) => own == k,
            _ => true,
        }
    }

    /// The step with which the difference for unknown `j` is taken.
    fn step(&self, x: &[f64], j: usize) -> f64 {
        // The participation of another mode may be many times that of the first, so its step is relative.
        let many = matches!(self.form.unknowns[j], Unknown::Participation(..));
        let scale = if many { STEP * x[j].abs().max(1.0) } else { STEP };
        if x[j] + scale > self.bounds[j].1 { -scale } else { scale }
    }

    /// Entries of record `k` with unknown `j` moved by `step`; none where there is no model.
    fn entries_at(&self, x: &[f64], (j, step): (usize, f64), k: usize) -> Option<Vec<Vec<f64>>> {
        let values = self.form.values(&moved(x, j, step))?;
        let motions = self.run(&values, k, &self.records[k].clock)?;
        Some(self.entries(&values, k, motions))
    }
}

impl Model for CoupledModel<'_> {
    fn bounds(&self) -> &[(f64, f64)] {
        &self.bounds
    }

    fn count(&self) -> usize {
        self.series.last().map_or(0, |s| s.entries.end)
    }

    fn evaluate(&self, x: &[f64], residuals: &mut [f64], derivatives: Option<&mut [Vec<f64>]>) -> bool {
        if self.stopped.load(Ordering::Relaxed) {
            return false;
        }
        // Points at which the model is run: the one asked for, and one with each unknown moved.
        let sought: Vec<usize> = derivatives.as_ref().map_or_else(Vec::new, |columns| {
            (0..columns.len()).filter(|j| !columns[*j].is_empty()).collect()
        });
        let steps: Vec<f64> = sought.iter().map(|j| self.step(x, *j)).collect();
        let moved = |(j, step): (&usize, &f64)| self.form.values(&moved(x, *j, *step));
        let points = std::iter::once(self.form.values(x)).chain(sought.iter().zip(&steps).map(moved));
        let Some(points) = points.collect::<Option<Vec<Values>>>() else { return false };
        // Making sliders takes as long as a thousand steps: records share them, and so do points whose laws are the same.
        let bins = self.records.first().map_or(0, |record| record.clock.bins);
        let is_own = |n: usize| n == 0 || points[n].laws != points[0].laws;
        let own = |n: usize| if is_own(n) { room(points[n].laws.len(), bins) } else { Vec::new() };
        let mut rooms: Vec<_> = (0..points.len()).map(own).collect();
        let sliders = points.iter().zip(&mut rooms).map(|(point, room)| populations(&point.laws, bins, room));
        let Some(sliders) = sliders.collect::<Option<Vec<Vec<Sliders<'_>>>>>() else { return false };
        // Jobs: each record at the point asked for, and at those that have an effect on it.
        let mut jobs: Vec<(usize, usize)> = (0..self.records.len()).map(|k| (k, 0)).collect();
        let of = |k: usize| {
            let all = sought.iter().enumerate();
            all.filter(move |(_, j)| Self::matters(self.form.unknowns[**j], k)).map(move |(i, _)| (k, i + 1))
        };
        jobs.extend((0..self.records.len()).flat_map(of));
        let work = |(k, n): &(usize, usize)| {
            let n = *n;
            let (values, sliders) = (&points[n], &sliders[if is_own(n) { n } else { 0 }]);
            let how = (self.samples[*k], self.quantity);
            let motions = run_with((self.form.sharing, values), sliders, *k, &self.records[*k].clock, how);
            if let Some(motions) = motions {
                return Some((self.entries(values, *k, motions), if n == 0 { 0.0 } else { steps[n - 1] }));
            }
            // Next to the edge of what holds together there is a model on the other side.
            let (j, step) = (*sought.get(n.checked_sub(1)?)?, -steps[n - 1]);
            Some((self.entries_at(x, (j, step), *k)?, step))
        };
        let found = in_parallel(&jobs, self.threads, &work);
        let series_of = |k: usize| self.series.iter().filter(move |s| s.record == k);
        let mut plain: Vec<Option<&Vec<Vec<f64>>>> = vec![None; self.records.len()];
        for ((k, _), entries) in jobs.iter().zip(&found).take(self.records.len()) {
            let Some((entries, _)) = entries else { return false };
            plain[*k] = Some(entries);
            for (series, own) in series_of(*k).zip(entries) {
                let out = &mut residuals[series.entries.clone()];
                for ((out, own), sought) in out.iter_mut().zip(own).zip(&series.sought) {
                    *out = own - sought / series.deviation;
                }
            }
        }
        let Some(derivatives) = derivatives else { return true };
        for column in derivatives.iter_mut() {
            column.fill(0.0);
        }
        for ((k, n), entries) in jobs.iter().zip(&found).skip(self.records.len()) {
            let j = sought[n - 1];
            let (Some((entries, step)), Some(plain)) = (entries, plain[*k]) else { return false };
            for ((series, moved), own) in series_of(*k).zip(entries).zip(plain) {
                let out = &mut derivatives[j][series.entries.clone()];
                out.iter_mut().zip(moved.iter().zip(own)).for_each(|(out, (a, b))| *out = (a - b) / step);
            }
        }
        true
    }
}

/// A point with unknown `j` moved by `step`.
fn moved(x: &[f64], j: usize, step: f64) -> Vec<f64> {
    let mut moved = x.to_vec();
    moved[j] += step;
    moved
}

fn root_mean_square(x: &[f64]) -> f64 {
    (x.iter().map(|x| x * x).sum::<f64>() / x.len().max(1) as f64).sqrt()
}
