//! Simulation in the loop: the parameters whose ring-down is the record itself.
//!
//! Forward model: the half-cycle map of iwan-core; compared are complex amplitudes in windows (the module `features`),
//! taken of record and model alike. Each record brings two unknowns of its own: amplitude and time of the turning point
//! next to its first sample. The joint is taken to have been loaded along its virgin curve up to there: exact for
//! a release from rest; later in a decay, where loops shrink slowly, the tips of the loops lie next to the virgin curve.
//!
//! First the logarithms of the amplitudes, with unwrapped phases, are brought together from several starts: no cycle is
//! lost on the way. Then the amplitudes themselves, weighted by each record's noise.

use std::f64::consts::{PI, TAU};

use iwan_core::Reversal;
use rustfft::num_complex::Complex64;

use crate::chart::{Chart, Scales};
use crate::curves::Quantity;
use crate::error::{Error, check, check_dt, check_samples};
use crate::features::{Whitening, Windows};
use crate::fit::predict;
use crate::least_squares::{Minimum, Search, TOLERANCE};
use crate::parameters::{COUNT, Parameter, Parameters};

/// Unknowns of each record: ln of the first amplitude, phase of the release.
const OWN: usize = 2;
/// Windows whose amplitude is below this part of the largest do not enter the first search.
const LOUD: f64 = 0.03;
/// φ_max over the largest amplitude, and β/(1+β), of the further starts.
const KNEES: [f64; 4] = [0.4, 1.0, 2.5, 10.0];
const DIRACS: [f64; 2] = [0.02, 0.4];
/// Part of ω0² that the joint has at most where nothing else limits it.
const MOST_JOINT: f64 = 0.9;
/// Part of ω0² that the joint has where it is next to none.
const LITTLE_JOINT: f64 = 1e-4;
/// φ_max over the largest amplitude where no record reaches it: any larger one would do.
pub(crate) const KNEE_UNSEEN: f64 = 2.0;
/// Iterations of the first search from each start, and of the last.
const ITERATIONS: (usize, usize) = (30, 100);
/// Hops over creases, as coordinate (K_T or F_S, β/(1+β)) and step.
const HOPS: [(usize, f64); 10] = [
    (4, -0.03),
    (4, 0.03),
    (4, -0.06),
    (4, 0.06),
    (4, -0.12),
    (4, 0.12),
    (4, -0.25),
    (4, 0.25),
    (5, -0.03),
    (5, 0.03),
];
/// Relative residual that hides the creases.
const CREASE: f64 = 5e-4;
/// Rounds of hops, and the part of the sum of squares to which a round must bring it down for another one.
const ROUNDS: usize = 8;
const WORTH: f64 = 0.9;
/// Relative reduction of the sum of squares at which searches end that are not the last.
const ROUGH: f64 = 1e-4;
/// … and of searches for a minimum under noise.
const FINE: f64 = 2e-6;
/// Starts that the last search goes on from.
const KEPT: usize = 3;
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
}

#[derive(Debug, Clone)]
struct Prepared {
    windows: Windows,
    whitening: Whitening,
    quantity: Quantity,
    dt: f64,
    /// Amplitudes as they are, and whitened.
    amplitudes: Vec<Complex64>,
    white: Vec<Complex64>,
    /// Standard deviation by which whitened residuals are divided.
    scale: f64,
    /// Displacement and time of the turning point that the unknowns are relative to.
    start: (f64, f64),
}

/// Buffers that all evaluations of a search share.
#[derive(Debug, Clone, Default)]
pub(crate) struct Workspace {
    stack: Vec<Reversal>,
    model: Vec<Complex64>,
}

impl Prepared {
    fn new(record: &RingDown<'_>, first: &Parameters) -> Result<Self, Error> {
        check_dt(record.dt)?;
        check_samples("record", record.samples, 32, "record longer")?;
        let per_cycle = 1.0 / (first.frequency * record.dt);
        check("samples per cycle", per_cycle, per_cycle >= 4.0, "at least 4", "sample faster")?;
        // The windows pass ±3/(4H): half of the band at most.
        let cycles = record.band.map_or(1.0, |band| 1.5 * first.frequency / band);
        let seconds = (record.samples.len() - 1) as f64 * record.dt;
        let windows = Windows::over(seconds, first.frequency, cycles);
        let amplitudes = windows.of_samples(record.samples, record.dt);
        let loudest = amplitudes.iter().map(|z| z.norm()).fold(0.0, f64::max);
        check(
            "amplitude of the record",
            loudest,
            windows.count == 0 || loudest > 0.0,
            "> 0",
            "check the channel",
        )?;
        let whitening = Whitening::new(&windows);
        let mut white = amplitudes.clone();
        whitening.apply(&mut white);
        let mut prepared = Self {
            windows,
            whitening,
            quantity: record.quantity,
            dt: record.dt,
            amplitudes,
            white,
            scale: 1.0,
            start: turning_point(record, first.frequency),
        };
        prepared.scale = prepared.root_mean_square();
        Ok(prepared)
    }

    fn root_mean_square(&self) -> f64 {
        let n = self.white.len().max(1) as f64;
        (self.white.iter().map(Complex64::norm_sqr).sum::<f64>() / n).sqrt()
    }

    fn start_at(&self, own: &[f64], omega: f64) -> (f64, f64) {
        (self.start.0 * own[0].exp(), self.start.1 + own[1] / omega)
    }

    /// Windows of the first search.
    fn loud(&self) -> usize {
        let loudest = self.amplitudes.iter().map(|z| z.norm()).fold(0.0, f64::max);
        let quiet = self.amplitudes.iter().position(|z| z.norm() < LOUD * loudest);
        quiet.unwrap_or(self.amplitudes.len()).max(8.min(self.amplitudes.len()))
    }
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
        let task = Self { chart: Chart::holding(held, amplitude), records, held: held.to_vec() };
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

    /// `first`, the same softening with knees and Diracs elsewhere, and next to no joint.
    fn starts(&self, first: &Parameters) -> Result<Vec<Vec<f64>>, Error> {
        let mut starts = vec![self.coordinates(first)?];
        let loudest = self.records.iter().map(|r| r.start.0.abs()).fold(0.0, f64::max);
        let (_, joint) = first.model()?;
        for knee in KNEES {
            for dirac in DIRACS {
                let (phi_max, beta) = (knee * loudest, dirac / (1.0 - dirac));
                let power = joint.r() * phi_max.powf(first.chi + 1.0) / (first.chi + 1.0);
                let c = (first.chi + 1.0) / (first.chi + 2.0);
                let k_t = (power * (1.0 + beta)).min(MOST_JOINT * (TAU * first.frequency).powi(2));
                let f_s = phi_max * k_t * (beta + c) / (1.0 + beta);
                let mut start = Parameters { k_t, f_s, beta, ..*first };
                for parameter in &self.held {
                    match parameter {
                        Parameter::KT => start.k_t = first.k_t,
                        Parameter::FS => start.f_s = first.f_s,
                        Parameter::Beta => start.beta = first.beta,
                        _ => {}
                    }
                }
                starts.push(self.coordinates(&start)?);
            }
        }
        if self.held.is_empty() {
            let (dissipation, frequency) = predict(first, loudest)?;
            let omega_squared = (TAU * frequency).powi(2);
            let k_t = LITTLE_JOINT * omega_squared;
            let damping_ratio = dissipation / (TAU * omega_squared * loudest * loudest);
            let f_s = k_t * loudest;
            starts.push(self.coordinates(&Parameters { frequency, damping_ratio, k_t, f_s, ..*first })?);
        }
        Ok(starts)
    }

    /// Where the first searches end, from each start; each half of the starts on a thread of its own.
    fn logarithmic(&self, starts: &[Vec<f64>]) -> Vec<Minimum> {
        let search = self.search(self.free(), (ITERATIONS.0, ROUGH));
        let of = |starts: &[Vec<f64>]| -> Vec<Minimum> {
            let mut work = Workspace::default();
            let mut log = |x: &[f64], out: &mut [f64]| self.log_residuals(x, out, &mut work);
            starts.iter().filter_map(|x| search.run(&mut log, x)).collect()
        };
        let (one, other) = starts.split_at(starts.len() / 2);
        std::thread::scope(|scope| {
            let second = scope.spawn(|| of(other));
            let mut found = of(one);
            found.extend(second.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
            found
        })
    }

    /// The best of all searches, roughly.
    pub(crate) fn solve(&mut self, first: &Parameters) -> Result<Minimum, Error> {
        let mut work = Workspace::default();
        let mut found = self.logarithmic(&self.starts(first)?);
        found.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        let Some(nearest) = found.first() else { return Err(no_ring_down()) };
        self.weigh(&nearest.x, &mut work);
        let mut best: Option<Minimum> = None;
        for near in found.iter().take(KEPT) {
            let minimum = self.minimise(&near.x, self.free(), ROUGH, &mut work);
            best = best.into_iter().chain(minimum).min_by(|a, b| a.cost.total_cmp(&b.cost));
        }
        let best = best.ok_or_else(no_ring_down)?;
        self.weigh(&best.x, &mut work);
        let cost = self.cost(&best.x, &mut work).ok_or_else(no_ring_down)?;
        Ok(Minimum { cost, ..best })
    }

    /// The minimum itself, next to a rough one.
    pub(crate) fn finish(&mut self, rough: &Minimum) -> Result<Minimum, Error> {
        let mut work = Workspace::default();
        let mut best = self.minimise(&rough.x, self.free(), FINE, &mut work).ok_or_else(no_ring_down)?;
        if self.refined(&best).relative_residual < CREASE {
            best = self.minimise(&best.x, self.free(), TOLERANCE, &mut work).ok_or_else(no_ring_down)?;
            best = self.hop(best, &mut work);
            self.weigh(&best.x, &mut work);
            best = self.minimise(&best.x, self.free(), TOLERANCE, &mut work).ok_or_else(no_ring_down)?;
        }
        Ok(best)
    }

    /// Leaves creases of the sum of squares: it has one wherever an amplitude of the ring-down equals φ_max, because
    /// the dissipation has a bend there. The knee and the Dirac are moved, all else follows, then all are free.
    fn hop(&self, mut best: Minimum, work: &mut Workspace) -> Minimum {
        let free = self.free();
        for _ in 0..ROUNDS {
            let before = best.cost;
            for (coordinate, step) in HOPS {
                if !free.contains(&coordinate) {
                    continue;
                }
                let (mut x, (low, high)) = (best.x.clone(), self.bounds()[coordinate]);
                x[coordinate] = (x[coordinate] + step).clamp(low, high);
                let others = free.iter().copied().filter(|j| *j != coordinate).collect();
                let found = self
                    .minimise(&x, others, ROUGH, work)
                    .and_then(|m| self.minimise(&m.x, free.clone(), ROUGH, work));
                best = found.filter(|f| f.cost < best.cost).unwrap_or(best);
            }
            if best.cost > WORTH * before {
                break;
            }
        }
        best
    }

    /// The least sum of squares when the joint never slips as a whole: no Dirac, φ_max as large as ω0² allows; from
    /// several points. None where a held parameter or that limit forbids it.
    pub(crate) fn micro_slip(&self, from: &[&[f64]]) -> Option<Minimum> {
        let (stiffness, dirac) = (self.chart.index(Parameter::KT), self.chart.index(Parameter::Beta));
        let free = self.free();
        let given = !(free.contains(&stiffness) && free.contains(&dirac));
        if self.chart.scales != Scales::SofteningAndStiffness || given {
            return None;
        }
        let others: Vec<usize> = free.into_iter().filter(|j| *j != stiffness && *j != dirac).collect();
        let mut work = Workspace::default();
        let mut best: Option<Minimum> = None;
        for x in from {
            let mut x = x.to_vec();
            (x[stiffness], x[dirac]) = (MOST_JOINT.ln(), 0.0);
            let mut log = |x: &[f64], out: &mut [f64]| self.log_residuals(x, out, &mut work);
            let near = self.search(others.clone(), (ITERATIONS.0, ROUGH)).run(&mut log, &x);
            let found = near.and_then(|m| self.minimise(&m.x, others.clone(), FINE, &mut work));
            best = best.into_iter().chain(found).min_by(|a, b| a.cost.total_cmp(&b.cost));
        }
        best.filter(|found| self.is_micro_slip(&found.x)).map(|found| self.with_near_knee(found))
    }

    /// The same ring-downs with φ_max at twice the largest amplitude.
    fn with_near_knee(&self, found: Minimum) -> Minimum {
        let p = self.chart.parameters(&found.x);
        let Ok((oscillator, joint)) = p.model() else { return found };
        let phi_max = KNEE_UNSEEN * self.loudest(&found.x);
        let k_t = joint.r() * phi_max.powf(p.chi + 1.0) / (p.chi + 1.0);
        if k_t >= MOST_JOINT * oscillator.omega0().powi(2) {
            return found;
        }
        let mut x = found.x.clone();
        x[self.chart.index(Parameter::KT)] = (k_t / oscillator.omega0().powi(2)).ln();
        Minimum { x, ..found }
    }

    /// The largest amplitude of the model's ring-downs.
    fn loudest(&self, x: &[f64]) -> f64 {
        self.starts_at(x).iter().map(|start| start.0.abs()).fold(0.0, f64::max)
    }

    /// Whether no record reaches φ_max.
    fn is_micro_slip(&self, x: &[f64]) -> bool {
        self.chart.parameters(x).model().is_ok_and(|(_, joint)| joint.phi_max() > self.loudest(x))
    }

    /// Goes on from a better point; none when its valley is not deeper.
    pub(crate) fn resume(&self, better: &Minimum, than: &Minimum) -> Option<Minimum> {
        let found = self.minimise(&better.x, self.free(), FINE, &mut Workspace::default())?;
        (found.cost < than.cost).then_some(found)
    }

    /// The records without a joint: `linear` holds one that is as good as none.
    pub(crate) fn without_joint(
        &self,
        linear: &Parameters,
        minimum: &Minimum,
    ) -> Result<(Self, Minimum), Error> {
        let joint = [Parameter::KT, Parameter::FS, Parameter::Chi, Parameter::Beta];
        let mut task = self.clone();
        task.held.extend(joint.iter().filter(|p| !self.held.contains(p)));
        task.chart = Chart::holding(&task.held, self.chart.amplitude);
        let mut x = task.coordinates(linear)?;
        x[COUNT..].copy_from_slice(&minimum.x[COUNT..]);
        let mut work = Workspace::default();
        let mut log = |x: &[f64], out: &mut [f64]| task.log_residuals(x, out, &mut work);
        let near =
            task.search(task.free(), (ITERATIONS.0, ROUGH)).run(&mut log, &x).ok_or_else(no_ring_down)?;
        let found = task.minimise(&near.x, task.free(), TOLERANCE, &mut work).ok_or_else(no_ring_down)?;
        Ok((task, found))
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

/// Displacement and time of the turning point next to the first sample: amplitude and phase over the first cycle and
/// the one half a cycle later, Hann-windowed, carried back to the first sample.
fn turning_point(record: &RingDown<'_>, frequency: f64) -> (f64, f64) {
    let omega = TAU * frequency;
    let cycle = ((1.0 / (frequency * record.dt)).round() as usize).min(record.samples.len() / 2);
    let amplitude = |from: usize| -> Complex64 {
        let part = &record.samples[from..from + cycle];
        let mean = part.iter().sum::<f64>() / cycle as f64;
        let term = |(n, x): (usize, &f64)| {
            let hann = 2.0 * (PI * (n as f64 + 0.5) / cycle as f64).sin().powi(2);
            Complex64::cis(-omega * (from + n) as f64 * record.dt) * ((x - mean) * hann * 2.0 / cycle as f64)
        };
        part.iter().enumerate().map(term).sum()
    };
    let half = cycle / 2;
    let (first, second) = (amplitude(0), amplitude(half));
    let rate = omega + (second / first).arg() / (half as f64 * record.dt);
    let middle = 0.5 * (cycle as f64 - 1.0) * record.dt;
    let (lag, power) = match record.quantity {
        Quantity::Displacement => (0.0, 0),
        Quantity::Velocity => (0.5 * PI, 1),
        Quantity::Acceleration => (PI, 2),
    };
    // Phase of the displacement at the first sample, between turning points at multiples of π.
    let phase = first.arg() + (omega - rate) * middle - lag;
    let turns = (phase / PI).round();
    let sign = if turns.rem_euclid(2.0) == 1.0 { -1.0 } else { 1.0 };
    (sign * first.norm() / omega.powi(power), (turns * PI - phase) / rate)
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
/// let start = (1.5 * joint.phi_max(), 0.0);
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
