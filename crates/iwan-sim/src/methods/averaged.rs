//! Averaging of a mode with parts, with curves, or with a joint whose friction drops, after the force has settled.

use std::time::Instant;

use iwan_core::progress::{Progress, UNWATCHED};
use iwan_core::{
    AveragedCurves, Averaging, Backbone, EnergyBalance, Error, Jenkins, ModalLaw, Motion, Newmark,
    Representation,
};

use crate::error::SimulationError;
use crate::joint_law::with_law;
use crate::methods::free_decay::{Decaying, fraction};
use crate::methods::task::{CHUNK, Room, Task, add, finite, stepped_finely};
use crate::methods::{outside, quality, run, stepped};
use crate::mode::Mode;
use crate::response::{Quality, Response};

/// Smallest number of time steps per small-amplitude period in the finer of the two runs with which averaging is compared. Extrapolated, the
/// two differ from the exact motion by a few 1e-6 of the peak, also beside dry friction, far below what averaging neglects.
const COMPARED_STEPS: f64 = 400.0;

/// Steps the mode finely while the force acts, and averages the decay after it. If `wanted`, fine time steps of the whole response give an
/// error estimate.
pub(crate) fn simulate(
    job: Decaying<'_>,
    wanted: bool,
    spare: Response,
    progress: Progress<'_>,
) -> Result<Response, SimulationError> {
    let Task { mode, dt, samples, .. } = job.task;
    if job.force.at(job.force.settled() + dt) != 0.0 {
        return Err(Error::Unsupported { what: "averaging needs a force that ends: use newmark" }.into());
    }
    let mut response = spare.cleared(dt, samples);
    let clock = Instant::now();
    let (start, forced) = forced(job, &mut response)?;
    // Sliders that slid in the largest motion so far go on sliding in the decay.
    let before = response.displacement[..job.settled].iter();
    let largest = before.fold(start.displacement.abs(), |most: f64, q| most.max(q.abs()));
    let length = (samples - 1 - job.settled) as f64 * dt;
    let mut buffers = response.samples();
    let mut out = buffers.between(job.settled, samples - 1);
    let oscillator = mode.oscillator()?;
    let energy = if let Some(curves) = &mode.curves {
        let mut decay = AveragedCurves::new(curves.points(), start)?;
        decay.sample(dt, &mut out)?;
        decay.energy(length)
    } else if let Some(law) = &mode.joint {
        let law = &law.after(largest);
        with_law!(law, law => {
            let mut decay = Averaging::of_law(ModalLaw::new(oscillator, Some(law), &mode.parts), start)?;
            decay.sample(dt, &mut out)?;
            decay.energy(length)
        })
    } else {
        let mut decay = Averaging::of_law(ModalLaw::<Jenkins>::new(oscillator, None, &mode.parts), start)?;
        decay.sample(dt, &mut out)?;
        decay.energy(length)
    };
    response.seconds = clock.elapsed().as_secs_f64();
    response.energy = forced.then(&energy);
    response.strongest = mode.joint.as_ref().map_or(f64::INFINITY, |law| law.strengths().1);
    let mut response = finite(response)?;
    if let Some(curves) = &mode.curves {
        response = outside::within(curves, response)?;
    }
    if progress(0.5).is_break() {
        return Err(SimulationError::Interrupted);
    }
    if wanted {
        let exact = exact(job, progress)?;
        let error = exact.map(|exact| distance(&exact, &response));
        response.quality =
            Quality { time_step_error: error, discretisation_error: Some(0.0), ..response.quality };
    }
    if progress(1.0).is_break() {
        return Err(SimulationError::Interrupted);
    }
    Ok(response)
}

/// Representation of the joint in the fine time steps: the continuum, or sliders where friction drops.
fn finely(mode: &Mode) -> Representation {
    /// Number of sliders. The dissipation D of a thousand sliders over amplitude is a staircase within 1 % of that of the density; a decay
    /// averages over the stairs.
    const FINE: usize = 1000;
    if mode.friction_drops() { Representation::in_a_mode(FINE) } else { Representation::Continuum }
}

/// Largest distance between the exact displacements and those of the response, relative to the peak.
fn distance(exact: &[f64], response: &Response) -> f64 {
    let pairs = exact.iter().zip(&response.displacement);
    let most = pairs.fold(0.0, |most: f64, (exact, q)| most.max((exact - q).abs()));
    quality::relative(most, response.peak_displacement())
}

/// Displacement of the same mode at the samples, extrapolated from two runs of fine time steps; none if the mode cannot be stepped, or if
/// a sampling interval holds more than some hundred periods, of which the steps would be too many to keep.
fn exact(job: Decaying<'_>, progress: Progress<'_>) -> Result<Option<Vec<f64>>, SimulationError> {
    let Task { mode, dt, .. } = job.task;
    let fraction = (0.5 * dt * mode.frequency * COMPARED_STEPS).ceil().max(1.0) as usize;
    if 2 * fraction > CHUNK {
        return Ok(None);
    }
    // The coarser run takes a third of the time.
    let Some(coarse) = by_steps(job, fraction, &|part| progress(0.5 + part / 6.0))? else { return Ok(None) };
    let Some(fine) = by_steps(job, 2 * fraction, &|part| progress(2.0 / 3.0 + part / 3.0))? else {
        return Ok(None);
    };
    Ok(Some(fine.iter().zip(&coarse).map(|(fine, coarse)| fine + (fine - coarse) / 3.0).collect()))
}

/// Displacement at the samples by `fraction` time steps in each sampling interval; none if the steps have no solution. The steps between
/// the samples are kept for one stretch only, so that memory does not grow with their number.
fn by_steps(
    job: Decaying<'_>,
    fraction: usize,
    progress: Progress<'_>,
) -> Result<Option<Vec<f64>>, SimulationError> {
    let Task { mode, dt, samples, .. } = job.task;
    let fine = dt / fraction as f64;
    let Ok(scheme) = Newmark::prewarped(fine, mode.oscillator()?.omega0()) else { return Ok(None) };
    let (force, _) = stepped_finely(mode, job.force, fine, job.settled * fraction + 1);
    let task = Task { force: &force, dt: fine, ..job.task };
    let mut room = Room::of(&job.task);
    let Ok(mut stepper) = stepped::begin(task, &scheme, finely(mode), &mut room) else { return Ok(None) };
    let intervals = (CHUNK / fraction).min(samples - 1);
    let mut stretch = Response::zeros(fine, intervals * fraction + 1);
    let mut displacement = Vec::<f64>::with_capacity(samples);
    let mut first = 0;
    while first < samples - 1 {
        let last = (first + intervals).min(samples - 1);
        let mut buffers = stretch.samples();
        let mut out = buffers.between(0, (last - first) * fraction);
        let rest = force.get(first * fraction..).unwrap_or(&[]);
        if stepper.advance(rest, &mut out).is_err() {
            return Ok(None);
        }
        // A stretch begins with the last sample of the one before.
        let known = usize::from(first > 0);
        displacement.extend(out.displacement.iter().step_by(fraction).skip(known));
        first = last;
        if progress(last as f64 / (samples - 1) as f64).is_break() {
            return Err(SimulationError::Interrupted);
        }
    }
    Ok(displacement.iter().all(|q| q.is_finite()).then_some(displacement))
}

/// Steps the forced part finely and writes its samples; returns the motion and the energy balance at its end.
fn forced(job: Decaying<'_>, response: &mut Response) -> Result<(Motion, EnergyBalance), SimulationError> {
    let Task { mode, dt, .. } = job.task;
    if job.settled == 0 {
        return Ok((mode.initial, EnergyBalance::default()));
    }
    let fraction = fraction(job)?;
    let (dt, samples) = (dt / fraction as f64, job.settled * fraction + 1);
    let (force, lacking) = stepped_finely(mode, job.force, dt, samples);
    let task = Task { mode, force: &force, dt, samples };
    let scheme = Newmark::prewarped(dt, mode.oscillator()?.omega0())?;
    let mut fine = run::newmark(task, &scheme, finely(mode), Response::default(), UNWATCHED)?;
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
    let last = |samples: &[f64]| samples.last().copied().unwrap_or_default();
    Ok((Motion { displacement: last(&fine.displacement), velocity: last(&fine.velocity) }, fine.energy))
}
