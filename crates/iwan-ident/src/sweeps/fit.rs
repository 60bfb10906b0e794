//! A mode's parameters from steady vibration, with ring-downs or without.

use std::f64::consts::TAU;

use super::data::SteadyData;
use super::intervals::{Known, profiles};
use super::start::{RESONANT, guesses, shown};
use super::task::Task;
use crate::curve_fit::{Compared, Verdict};
use crate::error::{Error, check};
use crate::likelihood::Likelihood;
use crate::parameters::{Parameter, Parameters};
use crate::profile::Profile;
use crate::search::{Minimum, TOLERANCE};
use crate::student::{LEAST_FREEDOM, student};

/// Largest number of points of each measurement in the first searches: with more, time is spent on digits that the later searches bring anyway.
const THINNED: usize = 120;
/// Relative reduction of the sum of squares at which the first searches end: which valley (local minimum) is deepest shows long before.
const ROUGH: f64 = 1e-3;
/// Largest numbers of iterations of the first searches and of the last ones.
const ITERATIONS: [usize; 2] = [25, 200];
/// Macro-slip is seen when the best fit without it has a sum of squares that is larger by at least this: as in [`profile`](crate::profile), where the reasons stand.
const SLIP_SEEN: f64 = 25.0;
/// Knee φ_max over the largest amplitude at which a search without macro-slip begins.
const BEYOND: f64 = 1.5;
/// Number of valleys that are followed to their minimum.
const FOLLOWED: usize = 3;
/// Number of rounds in which weights and errors are estimated, and largest number of better minima found by profiles from which these begin anew.
const ROUNDS: usize = 3;
/// Least number of values beyond the number of unknowns; with fewer the fit is refused.
const SPARE: usize = 3;

/// A mode's parameters from steady vibration.
#[derive(Debug, Clone)]
pub struct SteadyFit {
    /// The parameters.
    pub parameters: Parameters,
    /// Their profiles, with the 95 % intervals, in the order of [`Parameter::ALL`].
    pub profiles: Vec<Profile>,
    /// Deviance at the ends of the intervals.
    pub limit: f64,
    /// Relative drift of the frequency of each measurement: against the ring-downs, or where there are none against the first measurement.
    pub drifts: Vec<f64>,
    /// Static flexibility of all other modes at the measured point; 0 where no response was measured.
    pub others: f64,
    /// Relative errors of each measurement: for a response that of force and motion, twice; for a backbone those of its frequency and its damping.
    pub errors: Vec<[f64; 2]>,
    /// Smallest and largest amplitude of the modal displacement in the measurements.
    pub informed: [f64; 2],
    /// Whether macro-slip is seen: without it, only lower ends of K_T and F_S are told.
    pub slips: bool,
    /// Whether the model matches the frequency and dissipation that the points in resonance show.
    pub verdict: Verdict,
    /// Whether the search reached a minimum.
    pub converged: bool,
}

/// Fits one mode to stepped-sine responses and backbones; also to ring-downs, by the likelihood that an identification of them made.
///
/// Every point of a response is balanced by itself: with one harmonic, K_∞ + K_1(a) - ω² + i(cω + D/(πa²)) times the motion of
/// amplitude a equals the force. So points beyond a jump tell as much as others, and no response is computed. Errors
/// of force and motion are relative and of the same size, which is estimated for each measurement. Other modes add a
/// static flexibility. Each measurement has its own small drift of the linear frequency.
///
/// # Errors
/// [`Error::OutOfRange`] for points that are not positive; [`Error::TooShort`] for fewer points than unknowns;
/// [`Error::Refused`] where no point shows a resonance or no model describes the points.
///
/// ```
/// use std::f64::consts::{PI, TAU};
/// use iwan_core::Backbone;
/// use iwan_ident::{Parameters, sweeps::{BackbonePoint, SteadyData, fit_steady}};
/// let truth = Parameters { frequency: 124.0, damping_ratio: 1e-3, k_t: 4.45e4, f_s: 239.4, chi: -0.183, beta: 0.3 };
/// let (oscillator, joint) = truth.model()?;
/// let point = |i: i32| {
///     let a = 1e-5 * 10f64.powf(f64::from(i) / 12.0);
///     let omega = (oscillator.k_inf() + joint.harmonic_stiffness(a)).sqrt();
///     let loss = joint.dissipation(a) / (PI * a * a);
///     let damping_ratio = 1e-3 * oscillator.omega0() / omega + 0.5 * loss / (omega * omega);
///     BackbonePoint { amplitude: a, frequency: omega / TAU, damping_ratio }
/// };
/// let backbone = SteadyData::Backbone((0..40).map(point).collect());
/// let found = fit_steady(&[backbone], None, &[])?;
/// // Beyond macro-slip all six are told.
/// assert!((found.parameters.f_s / 239.4 - 1.0).abs() < 1e-5 && (found.parameters.chi + 0.183).abs() < 1e-5);
/// # Ok::<(), iwan_ident::Error>(())
/// ```
pub fn fit_steady(
    data: &[SteadyData],
    ring_downs: Option<&Likelihood>,
    held: &[(Parameter, f64)],
) -> Result<SteadyFit, Error> {
    check("measurements", data.len() as f64, !data.is_empty(), "at least one", "give a measurement")?;
    data.iter().try_for_each(SteadyData::checked)?;
    let mut starts = guesses(data)?;
    starts.extend(ring_downs.map(|likelihood| *likelihood.parameters()));
    for start in &mut starts {
        for &(parameter, value) in held {
            *start.get_mut(parameter) = value;
        }
    }
    let names: Vec<Parameter> = held.iter().map(|(parameter, _)| *parameter).collect();
    let task = Task::new(data, ring_downs, &names, &starts[0]);
    let (found, needed) = (task.count(), task.free().len() + SPARE);
    if found < needed {
        let remedy = "measure at more frequencies or amplitudes";
        return Err(Error::TooShort { what: "values (two a point)", found, needed, remedy });
    }
    let (task, minimum) = deepest(&task, data, &starts)?;
    let (slips, mut minimum) = seen_to_slip(&task, minimum);
    let limit = student(((task.count() - task.free().len()) as f64).max(LEAST_FREEDOM)).powi(2);
    let mut round = 0;
    let profiles = loop {
        // A better point that still comes in the last round is due to the searches' own tolerance.
        match profiles(&task, &minimum, Known { slips, limit, settled: round == ROUNDS }) {
            Err(better) => minimum = settled(&task, &better.x)?,
            Ok(all) => break all,
        }
        round += 1;
    };
    Ok(SteadyFit { profiles, limit, slips, ..result(&task, &minimum)? })
}

/// Whether macro-slip is seen, and the minimum to take: the one without macro-slip where the best fit is hardly better than it.
fn seen_to_slip(task: &Task<'_>, minimum: Minimum) -> (bool, Minimum) {
    let Some(knee) = task.chart.knee() else { return (true, minimum) };
    let largest = task.largest_knee();
    if minimum.x[knee] >= largest {
        return (false, minimum);
    }
    let mut x = minimum.x.clone();
    x[knee] = largest + BEYOND.ln();
    let without = task.without_slip();
    let stuck = without.minimise(&x, task.free(), TOLERANCE, ITERATIONS[1]);
    match stuck.filter(|stuck| stuck.cost - minimum.cost < SLIP_SEEN) {
        Some(stuck) => (false, stuck),
        None => (true, minimum),
    }
}

/// The problem with its weights and its minimum, in the deepest of the valleys (local minima) that the starts lie in.
///
/// What the points in resonance show is fitted first, as a backbone: its residuals are smooth in the parameters, where a resonance
/// that is missed by its width leaves a hundred times the force.
fn deepest<'a>(
    task: &Task<'a>,
    data: &[SteadyData],
    starts: &[Parameters],
) -> Result<(Task<'a>, Minimum), Error> {
    let shown: Vec<SteadyData> = shown(data).iter().map(thinned).collect();
    let rough = Task::new(&shown, None, &task.held, &starts[0]);
    let largest = task.sets.iter().flat_map(|set| set.data.amplitudes()).fold(0.0, f64::max);
    let mut valleys: Vec<(f64, Parameters)> =
        starts.iter().flat_map(|start| along_knees(&rough, start)).collect();
    valleys.sort_by(|a, b| a.0.total_cmp(&b.0));
    // All joints that stick throughout are one valley, however far their knees lie.
    let sticks = |p: &Parameters| p.model().is_ok_and(|(_, joint)| joint.phi_max() >= largest);
    let mut seen = false;
    valleys.retain(|(_, p)| !sticks(p) || !std::mem::replace(&mut seen, true));
    let follow = |(_, parameters): &(f64, Parameters)| {
        let mut task = task.clone();
        let mut x = task.coordinates(parameters).ok()?;
        for _ in 0..ROUNDS {
            task.weigh(&x).ok()?;
            x = task.minimise(&x, task.free(), ROUGH * ROUGH, ITERATIONS[1])?.x;
        }
        task.weigh(&x).ok()?;
        let found = settled(&task, &x).ok()?;
        Some((task.spread() + 0.5 * found.cost, task, found))
    };
    let followed = valleys.iter().take(FOLLOWED).filter_map(follow);
    let best = followed.min_by(|a, b| a.0.total_cmp(&b.0));
    best.map(|(_, task, found)| (task, found)).ok_or_else(no_model)
}

/// The valleys along the knee φ_max, as sum of squares and parameters: the knee is taken through its range with all else following, since the sum of squares has a crease
/// wherever an amplitude equals the knee; from each local minimum on, all unknowns are free.
fn along_knees(task: &Task<'_>, start: &Parameters) -> Vec<(f64, Parameters)> {
    let Ok(mut x) = task.coordinates(start) else { return Vec::new() };
    let free = task.free();
    let (sought, others): (Vec<usize>, Vec<usize>) =
        free.iter().partition(|j| task.chart.knee() == Some(**j));
    let mut scanned: Vec<Minimum> = Vec::new();
    if let [knee] = sought[..] {
        for at in task.knees() {
            x[knee] = at;
            let Some(found) = task.minimise(&x, others.clone(), ROUGH, ITERATIONS[0]) else { continue };
            x.clone_from(&found.x);
            scanned.push(found);
        }
    } else {
        scanned.extend(task.minimise(&x, free.clone(), ROUGH, ITERATIONS[0]));
    }
    let cost = |i: usize| scanned.get(i).map_or(f64::INFINITY, |found| found.cost);
    let lowest = (0..scanned.len()).filter(|&i| cost(i) <= cost(i + 1) && (i == 0 || cost(i) <= cost(i - 1)));
    lowest
        .filter_map(|i| task.minimise(&scanned[i].x, free.clone(), ROUGH, ITERATIONS[0]))
        .map(|found| (found.cost, task.chart.parameters(&found.x)))
        .collect()
}

fn no_model() -> Error {
    Error::Refused {
        finding: "no Iwan joint with a viscous damper describes these points".into(),
        remedy: "check quantity, phase and units of force and motion (--mass, where the shape is not mass-normalised)",
    }
}

fn settled(task: &Task<'_>, x: &[f64]) -> Result<Minimum, Error> {
    task.minimise(x, task.free(), TOLERANCE, ITERATIONS[1]).ok_or_else(no_model)
}

/// Every n-th point, so that no more than THINNED are left; the points are in the order of amplitude.
fn thinned(data: &SteadyData) -> SteadyData {
    let step = data.len().div_ceil(THINNED).max(1);
    match data {
        SteadyData::Response(points) => SteadyData::Response(points.iter().copied().step_by(step).collect()),
        SteadyData::Backbone(points) => SteadyData::Backbone(points.iter().copied().step_by(step).collect()),
    }
}

fn result(task: &Task<'_>, minimum: &Minimum) -> Result<SteadyFit, Error> {
    let parameters = task.chart.parameters(&minimum.x);
    let amplitudes = || task.sets.iter().flat_map(|set| set.data.amplitudes());
    let informed = [amplitudes().fold(f64::INFINITY, f64::min), amplitudes().fold(0.0, f64::max)];
    Ok(SteadyFit {
        parameters,
        profiles: Vec::new(),
        limit: f64::NAN,
        slips: true,
        drifts: task.drifts(&minimum.x),
        others: task.others(&minimum.x),
        errors: task.sets.iter().map(|set| set.errors).collect(),
        informed,
        verdict: verdict(task, minimum)?,
        converged: minimum.converged,
    })
}

/// Compares dissipation and frequency of the points in resonance with the model's.
fn verdict(task: &Task<'_>, minimum: &Minimum) -> Result<Verdict, Error> {
    let (mut dissipation, mut frequency) = (Vec::new(), Vec::new());
    for (set, mode) in task.sets.iter().zip(task.modes(&minimum.x)?) {
        let mut add = |a: f64, shown: [f64; 2], deviation: [f64; 2]| {
            let Some([hertz, damping]) = mode.free(a) else { return };
            let model = (TAU * damping * (TAU * hertz * a).powi(2)).ln();
            dissipation.push(Compared { measured: shown[0].ln(), deviation: deviation[0], model });
            frequency.push(Compared { measured: shown[1], deviation: deviation[1], model: hertz });
        };
        match set.data {
            SteadyData::Response(points) => {
                for shown in
                    points.iter().filter_map(|p| mode.shown(p)).filter(|s| s.size <= RESONANT * s.loss)
                {
                    let omega = TAU * shown.frequency;
                    let error = std::f64::consts::SQRT_2 * set.errors[0] * shown.size;
                    let hertz = 0.5 * error / (omega * TAU);
                    let dissipated = shown.dissipation;
                    add(shown.amplitude, [dissipated, shown.frequency], [error / shown.loss, hertz]);
                }
            }
            SteadyData::Backbone(points) => {
                for p in points {
                    let dissipated = TAU * p.damping_ratio * (TAU * p.frequency * p.amplitude).powi(2);
                    let deviation = [set.errors[1], set.errors[0] * p.frequency];
                    add(p.amplitude, [dissipated, p.frequency], deviation);
                }
            }
        }
    }
    Ok(Verdict::new(&dissipation, &frequency))
}
