//! Methods for free decay: time steps until the force has settled, then a method without time steps.

use std::time::Instant;

use iwan_core::{
    Averaging, Backbone, Continuum, Decay, EnergyBalance, Error, Grid, Hysteresis, JointEnergy, Motion,
    Newmark, Oscillator, Progress, Pulse, Reversal, Reversals,
};

use crate::error::SimulationError;
use crate::joint_law::with_law;
use crate::methods::event::{self, Cut};
use crate::methods::quality;
use crate::methods::task::{Room, Task, add, finite, stepped_finely};
use crate::response::{Quality, Response};
use crate::settings::Method;

/// Smallest number of time steps of the forced part per small-amplitude period. Their error, estimated with half as many steps, is 7e-7 of
/// the peak for a haversine of a fifth of a period and 6e-7 when the force causes macro-slip. Twice as many steps would leave a quarter of
/// the error at twice the time and memory.
const STEPS_A_PERIOD: f64 = 4000.0;

/// Smallest number of time steps in a quarter of a pulse, however short, as a share of [`STEPS_A_PERIOD`]: 400 steps in the whole pulse.
/// Without them a pulse of 0.2 ms on a mode with a period of 8 ms leaves an error of 5e-6 of the peak, with them 3e-7.
const SHARE_IN_A_PULSE: f64 = 0.025;

/// Largest number of samples of the forced part: at 32 bytes each 1.6 GB, which most users' machines have. A force that lasts longer is
/// refused by name, with the methods that step it at the sampling interval.
const MOST_FORCED: f64 = 5e7;

/// Smallest error that is reported, relative to the peak. Where the map is exact, as for a joint that never slips, the time steps with
/// which it is compared ([`first_cycles`]) differ from it by 1e-9 or less.
const QUADRATURE_ERROR: f64 = 2e-9;

/// Number of cycles of the decay that are stepped to check the map; they take 10 ms of computing time. The map's error is one of phase. It
/// grows in proportion to time in macro-slip, and by jumps where the motion passes the corners of a tabulated density. With only four
/// cycles, extrapolated in proportion, the estimate was 0.17 to 0.22 of the true error for four tabulated densities in 800 sets, and up to
/// 8.5 times a true error of 1e-8 for four-parameter joints that leave macro-slip later.
const STEPPED_CYCLES: f64 = 40.0;

/// The state at the end of the forced part.
struct Forced<S> {
    memory: Reversals<S>,
    velocity: f64,
    energy: EnergyBalance,
}

/// Input of a free-decay method: the task, the force, the method, and the number of steps until the force has settled.
#[derive(Clone, Copy)]
pub(crate) struct Decaying<'a> {
    pub(crate) task: Task<'a>,
    pub(crate) force: &'a Pulse<'a>,
    pub(crate) method: Method,
    pub(crate) settled: usize,
}

/// Half-cycle map or averaging; with error estimates if `wanted`.
pub(crate) fn simulate(
    job: Decaying<'_>,
    wanted: bool,
    spare: Response,
    progress: Progress<'_>,
) -> Result<Response, SimulationError> {
    let Some(law) = &job.task.mode.joint else {
        // A linear mode needs no map: its Taylor series are exact.
        let cut = Cut { bins: 1, grid: Grid::Uniform };
        return event::simulate(job.task, job.force, cut, wanted, progress);
    };
    with_law!(law, law => {
        let mut response = decay(job, law, STEPS_A_PERIOD, spare)?;
        if progress(0.5).is_break() {
            return Err(SimulationError::Interrupted);
        }
        if wanted {
            response.quality = estimate(job, law, &response)?;
        }
        if progress(1.0).is_break() {
            return Err(SimulationError::Interrupted);
        }
        Ok(response)
    })
}

/// Error of the forced part, estimated with half as many steps. For averaging, if larger, the difference to the half-cycle map.
fn estimate<B: Backbone>(
    job: Decaying<'_>,
    law: &B,
    response: &Response,
) -> Result<Quality, SimulationError> {
    let coarse = decay(job, law, 0.5 * STEPS_A_PERIOD, Response::default())?;
    let mut error = quality::difference(&coarse, response, 1) / 3.0 + QUADRATURE_ERROR;
    if job.method == Method::HalfCycle {
        error += first_cycles(job, law, response)?;
    }
    if job.method == Method::Averaging {
        let exact =
            decay(Decaying { method: Method::HalfCycle, ..job }, law, STEPS_A_PERIOD, Response::default())?;
        error = error.max(quality::difference(&exact, response, 1));
    }
    Ok(Quality { time_step_error: Some(error), discretisation_error: Some(0.0), ..response.quality })
}

/// Error of the map, estimated by time steps over the first cycles of the decay from the same state. Two runs of fine steps are
/// extrapolated, and their distance to the map is scaled up in proportion to time and to the remaining amplitude.
fn first_cycles<B: Backbone>(
    job: Decaying<'_>,
    law: &B,
    response: &Response,
) -> Result<f64, SimulationError> {
    let Task { mode, dt, samples, .. } = job.task;
    let oscillator = mode.oscillator()?;
    let cycles = (STEPPED_CYCLES / (mode.frequency * dt)).ceil() as usize;
    let count = cycles.max(2).min(samples - 1 - job.settled);
    let (joint, load) = (Continuum::new(law), mode.shape_at_force * job.force.at(job.force.settled() + dt));
    let start = forced(job, &oscillator, law, STEPS_A_PERIOD, &mut Response::zeros(dt, job.settled + 1))?;
    // An even number, so that its half is an integer too.
    let fraction = 2 * (0.5 * dt * mode.frequency * STEPS_A_PERIOD).ceil().max(1.0) as usize;
    let stepped = |fraction: usize| -> Result<Vec<f64>, SimulationError> {
        let scheme = Newmark::prewarped(dt / fraction as f64, oscillator.omega0())?;
        let mut memory = start.memory.clone();
        let mut fine = Response::zeros(dt / fraction as f64, count * fraction + 1);
        let force = vec![load; fine.displacement.len()];
        scheme.integrate(&oscillator, &joint, &mut memory, start.velocity, &force, &mut fine.samples())?;
        Ok(finite(fine)?.displacement.into_iter().step_by(fraction).collect())
    };
    let (fine, coarse) = (stepped(fraction)?, stepped(fraction / 2)?);
    let exact = fine.iter().zip(&coarse).map(|(fine, coarse)| fine + (fine - coarse) / 3.0);
    let decay = &response.displacement[job.settled..];
    let distance = exact.zip(decay).fold(0.0, |most: f64, (exact, q)| most.max((exact - q).abs()));
    // Largest product of time and amplitude over the whole decay, relative to that over the stepped cycles.
    let weighed =
        |range: std::ops::Range<usize>| range.fold(0.0, |most: f64, n| most.max(n as f64 * decay[n].abs()));
    let (seen, whole) = (weighed(0..count + 1), weighed(0..decay.len()));
    let growth = if seen > 0.0 { (whole / seen).max(1.0) } else { 1.0 };
    Ok(quality::relative(growth * distance, response.peak_displacement()))
}

fn decay<B: Backbone>(
    job: Decaying<'_>,
    law: &B,
    steps: f64,
    spare: Response,
) -> Result<Response, SimulationError> {
    let Task { mode, dt, samples, .. } = job.task;
    let oscillator = mode.oscillator()?;
    let mut response = spare.cleared(dt, samples);
    response.strongest = law.strengths().1;
    let clock = Instant::now();
    let forced = forced(job, &oscillator, law, steps, &mut response)?;
    let load = mode.shape_at_force * job.force.at(job.force.settled() + dt);
    let length = (samples - 1 - job.settled) as f64 * dt;
    let mut buffers = response.samples();
    let mut out = buffers.between(job.settled, samples - 1);
    let (energy, forgotten) = if job.method == Method::Averaging {
        if load != 0.0 {
            return Err(Error::Unsupported {
                what: "averaging needs a force that ends: use half-cycle, newmark or event",
            }
            .into());
        }
        let displacement = Continuum::new(law).displacement(&forced.memory);
        let start = Motion { displacement, velocity: forced.velocity };
        let mut decay = Averaging::new(&oscillator, law, start)?;
        decay.sample(dt, &mut out)?;
        (decay.energy(length), forced.memory.forgotten())
    } else {
        let mut decay = Decay::from_memory(&oscillator, law, load, forced.memory, forced.velocity)?;
        decay.sample(dt, &mut out)?;
        (decay.energy(), decay.memory().forgotten())
    };
    response.seconds = clock.elapsed().as_secs_f64();
    response.energy = forced.energy.then(&energy);
    response.quality.forgotten_force = forgotten;
    finite(response)
}

/// Number of time steps of the forced part per sampling interval.
pub(crate) fn fraction(job: Decaying<'_>) -> Result<usize, Error> {
    fraction_of(job, STEPS_A_PERIOD)
}

fn fraction_of(job: Decaying<'_>, steps: f64) -> Result<usize, Error> {
    let Task { mode, dt, .. } = job.task;
    // An even number, so that its half is an integer too.
    let resolved = (mode.frequency * steps).max(SHARE_IN_A_PULSE * steps / job.force.longest_step());
    let fraction = 2.0 * (0.5 * dt * resolved).ceil().max(1.0);
    let (name, value) = ("force duration", job.settled as f64 * dt);
    if fraction * job.settled as f64 > MOST_FORCED {
        let allowed = "is too long beside the mode's period to be stepped finely: use newmark or event";
        return Err(Error::OutOfRange { name, value, allowed });
    }
    Ok(fraction as usize)
}

/// Steps the forced part (continuum, average acceleration) at a fraction of the sampling interval.
fn forced<B: Backbone>(
    job: Decaying<'_>,
    oscillator: &Oscillator,
    law: &B,
    steps: f64,
    response: &mut Response,
) -> Result<Forced<Vec<Reversal>>, SimulationError> {
    let Task { mode, dt, .. } = job.task;
    let joint = Continuum::new(law);
    let mut memory = joint.virgin(vec![Reversal::default(); Room::of(&job.task).reversals])?;
    joint.advance(&mut memory, mode.initial.displacement);
    let velocity = mode.initial.velocity;
    if job.settled == 0 {
        return Ok(Forced { memory, velocity, energy: EnergyBalance::default() });
    }
    let fraction = fraction_of(job, steps)?;
    let scheme = Newmark::prewarped(dt / fraction as f64, oscillator.omega0())?;
    let mut fine = Response::zeros(dt / fraction as f64, job.settled * fraction + 1);
    let (force, lacking) = stepped_finely(mode, job.force, fine.dt, fine.displacement.len());
    let start = joint.stored_energy(&memory);
    let velocity =
        scheme.integrate(oscillator, &joint, &mut memory, velocity, &force, &mut fine.samples())?;
    let stored = JointEnergy { start, end: joint.stored_energy(&memory) };
    let energy = scheme.energy(oscillator, stored, &force, &fine.samples());
    let mut fine = finite(Response { energy, ..fine })?;
    add(lacking.as_deref().unwrap_or(&[]), &mut fine.acceleration);
    let histories = [&fine.displacement, &fine.velocity, &fine.acceleration, &fine.joint_force];
    let targets = [
        &mut response.displacement,
        &mut response.velocity,
        &mut response.acceleration,
        &mut response.joint_force,
    ];
    for (history, target) in histories.into_iter().zip(targets) {
        target.iter_mut().zip(history.iter().step_by(fraction)).for_each(|(t, h)| *t = *h);
    }
    Ok(Forced { memory, velocity, energy })
}
