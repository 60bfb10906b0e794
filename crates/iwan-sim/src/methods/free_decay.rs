//! Methods for free decay: the force is stepped until it has settled, the decay that follows is not.

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

/// Time steps of the forced part per small-amplitude period, at least. What they leave is told by half as many:
/// 7e-7 of the peak for a haversine of a fifth of a period, 6e-7 when the force brings macro-slip. Twice as many
/// would leave a quarter, at a time and a memory of twice as much.
const STEPS_A_PERIOD: f64 = 4000.0;

/// Share of [`STEPS_A_PERIOD`] that falls into a quarter of a pulse, however short: 400 steps over the whole of it.
/// Without them a pulse of 0.2 ms on a mode of 8 ms leaves 5e-6 of the peak, with them 3e-7.
const SHARE_IN_A_PULSE: f64 = 0.025;

/// Most samples of the forced part: at 32 bytes each 1.6 GB, which the machines of most users have. A force that
/// lasts longer is refused by name, with the methods that step it at the sampling interval.
const MOST_FORCED: f64 = 5e7;

/// What is said at least, relative to the peak: where the map is exact, as for a joint that never slips, time steps beside it ([`first_cycles`]) differ by 1e-9 and less.
const QUADRATURE_ERROR: f64 = 2e-9;

/// Cycles of the decay that are stepped beside the map: 10 ms. Its error is one of phase, which grows in proportion to time in macro-slip, and by jumps where the corners of
/// a tabulated density are passed. With four cycles, carried on in proportion, 0.17 to 0.22 of the true error was told of four tabulated densities in 800 sets, and up to 8.5 times
/// a true 1e-8 of four-parameter joints that come out of macro-slip later.
const STEPPED_CYCLES: f64 = 40.0;

/// The forced part, sampled finely, and the state that it ends in.
struct Forced<S> {
    memory: Reversals<S>,
    velocity: f64,
    energy: EnergyBalance,
}

/// What a free-decay method is given besides the mode: force, method, number of samples until the force has settled.
#[derive(Clone, Copy)]
pub(crate) struct Decaying<'a> {
    pub(crate) task: Task<'a>,
    pub(crate) force: &'a Pulse<'a>,
    pub(crate) method: Method,
    pub(crate) settled: usize,
}

/// Half-cycle map or averaging, with the error estimate when `quality` is wanted.
pub(crate) fn simulate(
    job: Decaying<'_>,
    wanted: bool,
    spare: Response,
    progress: Progress<'_>,
) -> Result<Response, SimulationError> {
    let Some(law) = &job.task.mode.joint else {
        // A linear mode has nothing to map: its series are exact.
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

/// Error of the forced part's steps by halving their number; for averaging, the distance to the map as well.
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

/// Error of the map, from its first cycles beside time steps from the same state on: two runs of fine steps are extrapolated, and the distance is carried on in
/// proportion to time and to the amplitude that is left.
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
    // An even number, so that half of it is another.
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
    // Where time times amplitude is largest, against where the steps end.
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

/// Steps of the forced part in one sampling interval.
pub(crate) fn fraction(job: Decaying<'_>) -> Result<usize, Error> {
    fraction_of(job, STEPS_A_PERIOD)
}

fn fraction_of(job: Decaying<'_>, steps: f64) -> Result<usize, Error> {
    let Task { mode, dt, .. } = job.task;
    // An even number, so that half of it is another.
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
