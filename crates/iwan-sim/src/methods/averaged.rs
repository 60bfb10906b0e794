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
use crate::methods::task::{Task, add, finite, stepped_finely};
use crate::methods::{outside, quality, run};
use crate::mode::Mode;
use crate::response::{Quality, Response};

/// Steps the mode finely while the force acts, and averages the decay after it. If `wanted`, time steps at the sampling interval give an
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
        let steps = stepped(job.task);
        let error = steps.map(|steps| quality::difference(&steps, &response, 1));
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

/// The same mode in time steps at the sampling interval; none if that interval is too long.
fn stepped(task: Task<'_>) -> Option<Response> {
    let scheme = Newmark::prewarped(task.dt, task.mode.oscillator().ok()?.omega0()).ok()?;
    run::newmark(task, &scheme, finely(task.mode), Response::default(), UNWATCHED).ok()
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
