//! Initial motions of records and the size of their motions, before any fit.

use std::f64::consts::TAU;
use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use super::model::{Plan, Prepared};
use super::motion::{Clock, Sums, amplitude, at_samples, run};
use super::records::{CoupledRecord, CoupledTask, Seen};
use super::unknowns::{Sharing, Values};

/// Periods of the slowest mode, counted from the largest load, over which shapes at the load are first found as if the modes were linear. Within five such periods joints
/// soften and damp a mode that is five times as fast so far that its shape comes out half as large as it is.
const FIRST_PERIODS: f64 = 1.0;
/// Periods of a mode over which its amplitude at the start of a free decay is found: its joints soften and damp it by a few per cent in that time.
const AT_FIRST: f64 = 4.0;

/// Records with their clocks, plans of series, initial motions and sizes.
#[derive(Debug, Clone)]
pub(super) struct Opened {
    pub(super) records: Vec<Prepared>,
    pub(super) plans: Vec<Plan>,
    pub(super) initial: Vec<Vec<[f64; 2]>>,
    pub(super) sizes: Vec<Vec<f64>>,
}

impl Opened {
    /// Time steps of all records together.
    pub(super) fn steps(&self) -> usize {
        self.records.iter().map(|record| record.clock.steps_for(record.motions[0].len())).sum()
    }

    /// Largest amplitude of each mode in any record.
    pub(super) fn largest(&self) -> Vec<f64> {
        let modes = self.sizes.first().map_or(0, Vec::len);
        (0..modes).map(|r| self.sizes.iter().map(|of_record| of_record[r]).fold(0.0, f64::max)).collect()
    }

    /// Clocks of the same records with `times` times the steps, and more sliders.
    pub(super) fn finer(task: &CoupledTask<'_>, records: &[CoupledRecord], times: usize) -> Vec<Clock> {
        let fastest = task.modes.iter().map(|m| m.parameters.frequency).fold(0.0, f64::max);
        let of = |record: &CoupledRecord| Clock::finer(record.dt, record.force.as_deref(), fastest, times);
        records.iter().map(of).collect()
    }

    /// Prepares records by the start frequencies of the modes.
    pub(super) fn new(task: &CoupledTask<'_>, records: &[CoupledRecord]) -> Self {
        let frequencies: Vec<f64> = task.modes.iter().map(|m| m.parameters.frequency).collect();
        let fastest = frequencies.iter().copied().fold(0.0, f64::max);
        let prepared = records.iter().map(|record| Prepared {
            clock: Clock::new(record.dt, record.force.as_deref(), fastest),
            motions: record.motions.clone(),
        });
        let (mut plans, mut initial, mut sizes) = (Vec::new(), Vec::new(), Vec::new());
        for (k, record) in records.iter().enumerate() {
            let forced = record.force.is_some();
            let whole = forced && task.seen == Seen::Sum;
            for mode in 0..if whole { 1 } else { frequencies.len() } {
                let motion = if task.seen == Seen::Modes { mode } else { 0 };
                let sums = if forced {
                    Sums::of_forced(record.dt, fastest)
                } else {
                    Sums::of_free(record.dt, &frequencies, mode)
                };
                plans.push((k, motion, mode, sums));
            }
            let begun: Vec<[f64; 2]> =
                (0..frequencies.len()).map(|r| begin(task, record, &frequencies, r)).collect();
            let size = |(r, [q, v]): (usize, &[f64; 2])| q.hypot(v / (TAU * frequencies[r])).max(1e-300);
            sizes.push(begun.iter().enumerate().map(size).collect());
            initial.push(if forced { vec![[0.0; 2]; frequencies.len()] } else { begun });
        }
        Self { records: prepared.collect(), plans, initial, sizes }
    }
}

/// Displacement and velocity of a mode `r` at the first sample, from its amplitude over the first periods.
fn begin(task: &CoupledTask<'_>, record: &CoupledRecord, frequencies: &[f64], r: usize) -> [f64; 2] {
    let samples = &record.motions[if task.seen == Seen::Modes { r } else { 0 }];
    let omega = TAU * frequencies[r];
    let others = frequencies.iter().enumerate().filter(|(i, _)| *i != r);
    let apart = others.map(|(_, f)| (f - frequencies[r]).abs()).fold(f64::INFINITY, f64::min);
    let length = ((AT_FIRST / frequencies[r]).max(2.0 / apart) / record.dt).ceil() as usize;
    let [re, im] = amplitude(samples, length.max(8), omega * record.dt);
    // q = Re Z exp(iωt), and the sensor shows (iω)^p of it, with p the number of derivatives that it measures.
    let (mut q, power) = ([re, im], task.quantity.power());
    for _ in 0..power {
        q = [q[1] / omega, -q[0] / omega];
    }
    [q[0], -omega * q[1]]
}

/// Shapes of the modes at the load, by least squares over the first periods of the records `of`, as if the modes were linear; none where that has no solution.
pub(super) fn shapes_at_force(
    task: &CoupledTask<'_>,
    opened: &Opened,
    linear: &Values,
    of: Range<usize>,
) -> Option<Vec<f64>> {
    let n = linear.frequency.len();
    let slowest = linear.frequency.iter().copied().fold(f64::INFINITY, f64::min);
    let unit = Values { shape_at_force: vec![1.0; n], ..linear.clone() };
    let (mut square, mut right) = (DMatrix::zeros(n, n), DVector::zeros(n));
    for (k, record) in task.records.iter().enumerate().filter(|(k, _)| of.contains(k)) {
        let all = record.motions[0].len();
        let load = record.force.as_deref().unwrap_or(&[]);
        let peak = (0..load.len()).max_by(|a, b| load[*a].abs().total_cmp(&load[*b].abs())).unwrap_or(0);
        let samples = (peak + (FIRST_PERIODS / (slowest * record.dt)) as usize).clamp(16.min(all), all);
        let clock = &opened.records[k].clock;
        let Some(found) = run((Sharing::Linear, &unit), k, clock, samples, task.quantity) else { continue };
        let motions: Vec<Vec<f64>> =
            found.modes.iter().map(|rows| at_samples(rows, found.every, samples)).collect();
        // Each motion counts relative to its own size, so that soft blows count as much as hard ones.
        for (m, measured) in record.motions.iter().enumerate() {
            let size: f64 = measured[..samples].iter().map(|x| x * x).sum::<f64>().max(f64::MIN_POSITIVE);
            let seen: Vec<usize> = if task.seen == Seen::Modes { vec![m] } else { (0..n).collect() };
            let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>() / size;
            for &r in &seen {
                right[r] += product(&motions[r], &measured[..samples]);
                for &other in &seen {
                    square[(r, other)] += product(&motions[r], &motions[other]);
                }
            }
        }
    }
    let solved = square.lu().solve(&right);
    let usable = |x: &DVector<f64>| x.iter().all(|x| x.is_finite() && *x != 0.0);
    solved.filter(usable).map(|x| x.iter().copied().collect())
}
