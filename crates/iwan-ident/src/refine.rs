//! Simulation in the loop: the parameters whose ring-down is the record itself.
//!
//! The forward model is the half-cycle map of iwan-core. Each record brings two unknowns of its own, displacement and
//! velocity at its first sample. The joint is taken to have been loaded along its virgin curve up to that sample: exact
//! for a release from rest and for the first swing after an impact; later in a decay, where loops shrink slowly, the
//! tips of the loops lie next to the virgin curve.

use std::f64::consts::TAU;

use iwan_core::{Decay, Reversal, Samples};

use crate::curves::Quantity;
use crate::error::{Error, check, check_dt, check_samples};
use crate::least_squares::{Minimum, TOLERANCE, minimise};
use crate::parameters::{COUNT, Parameter, Parameters};

/// Samples per cycle that are compared, at least: more say little more about a sinusoid.
const PER_CYCLE: f64 = 20.0;
/// Cycles of the first search; each next one takes twice as many, so that the phase is never lost. A short first search
/// can end in a valley of its own: further beginnings are tried until two of them agree, and the best is kept.
const FIRST_CYCLES: [f64; 4] = [4.0, 8.0, 3.0, 6.0];
/// Relative difference in the sum of squares at which two searches agree.
const AGREE: f64 = 1e-4;
/// Relative residual (root mean square) at which nothing is left to improve.
const NOTHING_LEFT: f64 = 1e-6;
/// Iterations of one search.
const ITERATIONS: usize = 60;

/// A ring-down in free decay: one mode, mass-normalised, without filter, its first sample moving outwards or at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RingDown<'a> {
    /// Samples.
    pub samples: &'a [f64],
    /// Sampling interval, s.
    pub dt: f64,
    /// What was measured.
    pub quantity: Quantity,
}

/// Parameters that reproduce records, and what is left over.
#[derive(Debug, Clone, PartialEq)]
pub struct Refined {
    /// The parameters.
    pub parameters: Parameters,
    /// Displacement and velocity at the first sample of each record.
    pub starts: Vec<(f64, f64)>,
    /// Standard deviation of a record's samples about the model, in the unit of each record.
    pub residual: Vec<f64>,
    /// Root mean square of all residuals over that of the records.
    pub relative_residual: f64,
    /// Correlation of neighbouring residuals: near 0 when only noise is left, near 1 when the model misses something.
    pub correlation: f64,
    /// Whether the search ended by itself.
    pub converged: bool,
}

/// The records in the form that the search works on.
pub(crate) struct Task {
    records: Vec<Thinned>,
    /// Parameters that are not sought.
    held: Vec<usize>,
}

struct Thinned {
    samples: Vec<f64>,
    dt: f64,
    quantity: Quantity,
    /// Root mean square: residuals are relative to it.
    scale: f64,
    /// Unit of displacement and of velocity for the coordinates of the start.
    unit: (f64, f64),
}

impl Task {
    /// Checks the records; `first` gives the frequency that decides on the thinning.
    pub(crate) fn new(
        records: &[RingDown<'_>],
        first: &Parameters,
        held: &[Parameter],
    ) -> Result<Self, Error> {
        let thinned =
            records.iter().map(|r| Thinned::new(r, first.frequency)).collect::<Result<Vec<_>, _>>()?;
        check("records", records.len() as f64, !records.is_empty(), "at least one", "give a record")?;
        let index = |p: &Parameter| Parameter::ALL.iter().position(|q| q == p);
        Ok(Self { records: thinned, held: held.iter().filter_map(index).collect() })
    }

    /// Coordinates of the parameters and of the starts that fit the first samples.
    pub(crate) fn start(&self, first: &Parameters) -> Vec<f64> {
        let mut x = first.coordinates().to_vec();
        for record in &self.records {
            let q = record.first_displacement(first.frequency);
            x.extend([q / record.unit.0, 0.0]);
        }
        x
    }

    pub(crate) fn count(&self, seconds: f64) -> usize {
        self.records.iter().map(|r| r.within(seconds)).sum()
    }

    /// Unknowns without those that are held.
    pub(crate) fn free(&self) -> Vec<usize> {
        let all = COUNT + 2 * self.records.len();
        (0..all).filter(|j| !self.held.contains(j)).collect()
    }

    /// Residuals over the first `seconds` (infinite: all) of each record, relative to its root mean square.
    pub(crate) fn residuals(&self, x: &[f64], seconds: f64, out: &mut [f64], work: &mut Workspace) -> bool {
        let parameters = Parameters::from_coordinates(x);
        let mut from = 0;
        for (i, record) in self.records.iter().enumerate() {
            let n = record.within(seconds);
            let state = (x[COUNT + 2 * i] * record.unit.0, x[COUNT + 2 * i + 1] * record.unit.1);
            if work.simulate(&parameters, state, record.dt, n).is_err() {
                return false;
            }
            let model = work.of(record.quantity);
            for (k, r) in out[from..from + n].iter_mut().enumerate() {
                *r = (record.samples[k] - model[k]) / record.scale;
            }
            from += n;
        }
        true
    }

    /// One search over the first `seconds`.
    pub(crate) fn search(
        &self,
        x: &[f64],
        seconds: f64,
        free: &[usize],
        work: &mut Workspace,
    ) -> Option<Minimum> {
        let mut residuals = |x: &[f64], out: &mut [f64]| self.residuals(x, seconds, out, work);
        minimise(&mut residuals, self.count(seconds), x, free, (ITERATIONS, TOLERANCE))
    }

    fn longest(&self) -> f64 {
        self.records.iter().map(|r| r.samples.len() as f64 * r.dt).fold(0.0, f64::max)
    }
}

impl Thinned {
    fn new(record: &RingDown<'_>, frequency: f64) -> Result<Self, Error> {
        check_dt(record.dt)?;
        check_samples("record", record.samples, 32, "record longer")?;
        let per_cycle = 1.0 / (frequency * record.dt);
        let remedy = "sample faster";
        check("samples per cycle", per_cycle, per_cycle >= 4.0, "at least 4", remedy)?;
        let stride = ((per_cycle / PER_CYCLE) as usize).max(1);
        let samples: Vec<f64> = record.samples.iter().copied().step_by(stride).collect();
        let scale = (samples.iter().map(|x| x * x).sum::<f64>() / samples.len() as f64).sqrt();
        check("root mean square of the record", scale, scale > 0.0, "> 0", "check the channel")?;
        let top = record.samples.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let omega = TAU * frequency;
        let q = match record.quantity {
            Quantity::Acceleration => top / (omega * omega),
            Quantity::Velocity => top / omega,
            Quantity::Displacement => top,
        };
        let dt = record.dt * stride as f64;
        Ok(Self { samples, dt, quantity: record.quantity, scale, unit: (q, omega * q) })
    }

    fn within(&self, seconds: f64) -> usize {
        ((seconds / self.dt).round() as usize).clamp(16.min(self.samples.len()), self.samples.len())
    }

    fn first_displacement(&self, frequency: f64) -> f64 {
        let omega = TAU * frequency;
        match self.quantity {
            Quantity::Acceleration => -self.samples[0] / (omega * omega),
            Quantity::Velocity => 0.0,
            Quantity::Displacement => self.samples[0],
        }
    }
}

/// Buffers that all simulations of a search share.
#[derive(Default)]
pub(crate) struct Workspace {
    response: [Vec<f64>; 4],
    stack: Vec<Reversal>,
}

impl Workspace {
    fn simulate(&mut self, p: &Parameters, start: (f64, f64), dt: f64, samples: usize) -> Result<(), Error> {
        let (oscillator, joint) = p.model()?;
        self.response.iter_mut().for_each(|v| v.resize(samples, 0.0));
        let half_cycles = (2.5 * samples as f64 * dt * p.frequency) as usize + 16;
        if self.stack.len() < half_cycles {
            self.stack.resize(half_cycles, Reversal::default());
        }
        let [displacement, velocity, acceleration, joint_force] = &mut self.response;
        let mut out = Samples { displacement, velocity, acceleration, joint_force };
        let mut decay = Decay::new(&oscillator, &joint, 0.0, start, self.stack.as_mut_slice())?;
        Ok(decay.sample(dt, &mut out)?)
    }

    fn of(&self, quantity: Quantity) -> &[f64] {
        &self.response[match quantity {
            Quantity::Displacement => 0,
            Quantity::Velocity => 1,
            Quantity::Acceleration => 2,
        }]
    }
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
/// let record = RingDown { samples: &out[2], dt: 2e-4, quantity: Quantity::Acceleration };
/// let first = Parameters { k_t: 5e4, f_s: 220.0, chi: -0.3, beta: 0.5, ..truth };
/// let refined = refine(&[record], &first, &[])?;
/// assert!((refined.parameters.f_s / truth.f_s - 1.0).abs() < 1e-4);
/// # Ok::<(), iwan_ident::Error>(())
/// ```
pub fn refine(records: &[RingDown<'_>], first: &Parameters, held: &[Parameter]) -> Result<Refined, Error> {
    first.model()?;
    let task = Task::new(records, first, held)?;
    let minimum = solve(&task, first)?;
    Ok(task.refined(&minimum))
}

/// The best of several searches.
fn solve(task: &Task, first: &Parameters) -> Result<Minimum, Error> {
    let mut best: Option<Minimum> = None;
    for cycles in FIRST_CYCLES {
        let found = lengthening(task, first, cycles)?;
        let nothing_left = found.cost <= NOTHING_LEFT * NOTHING_LEFT * task.count(f64::INFINITY) as f64;
        let agreed = best.as_ref().is_some_and(|b| (b.cost - found.cost).abs() <= AGREE * b.cost);
        if best.as_ref().is_none_or(|b| found.cost < b.cost) {
            best = Some(found);
        }
        if nothing_left || agreed {
            break;
        }
    }
    best.ok_or_else(no_ring_down)
}

fn no_ring_down() -> Error {
    let finding = "the start values have no ring-down".into();
    Error::Refused { finding, remedy: "start nearer to the solution" }
}

/// Searches with longer and longer horizons, the first of so many `cycles`.
fn lengthening(task: &Task, first: &Parameters, cycles: f64) -> Result<Minimum, Error> {
    let mut work = Workspace::default();
    let (mut x, free, end) = (task.start(first), task.free(), task.longest());
    let mut seconds = if cycles / first.frequency < end { cycles / first.frequency } else { f64::INFINITY };
    loop {
        let found = task.search(&x, seconds, &free, &mut work).ok_or_else(no_ring_down)?;
        x.clone_from(&found.x);
        if seconds == f64::INFINITY {
            return Ok(found);
        }
        seconds = if 2.0 * seconds < end { 2.0 * seconds } else { f64::INFINITY };
    }
}

impl Task {
    pub(crate) fn refined(&self, minimum: &Minimum) -> Refined {
        let (x, seconds) = (&minimum.x, f64::INFINITY);
        let mut out = vec![0.0; self.count(seconds)];
        self.residuals(x, seconds, &mut out, &mut Workspace::default());
        let (mut residual, mut from) = (Vec::new(), 0);
        for record in &self.records {
            let part = &out[from..from + record.samples.len()];
            let mean = part.iter().map(|r| r * r).sum::<f64>() / part.len() as f64;
            residual.push(mean.sqrt() * record.scale);
            from += part.len();
        }
        let square: f64 = out.iter().map(|r| r * r).sum();
        let product: f64 = out.windows(2).map(|r| r[0] * r[1]).sum();
        let unit = |i: usize| self.records[i].unit;
        Refined {
            parameters: Parameters::from_coordinates(x),
            starts: (0..self.records.len())
                .map(|i| (x[COUNT + 2 * i] * unit(i).0, x[COUNT + 2 * i + 1] * unit(i).1))
                .collect(),
            residual,
            relative_residual: (square / out.len() as f64).sqrt(),
            correlation: product / square.max(f64::MIN_POSITIVE),
            converged: minimum.converged,
        }
    }
}
