//! Error estimates from companion runs at twice the time step.

use iwan_core::progress::UNWATCHED;
use iwan_core::{Newmark, Pulse, Representation};

use crate::error::SimulationError;
use crate::methods::between::{Polyline, unseen};
use crate::methods::run::newmark;
use crate::methods::task::{Task, seen_by_double_steps};
use crate::mode::Mode;
use crate::response::{Quality, Response};

/// Shortest response, in samples of the companion, that gets an estimate: over fewer points the largest difference
/// says little, as they may all lie where two wrong responses cross. The number is arbitrary; responses that anyone
/// looks at are longer.
pub(crate) const FEWEST: usize = 8;

/// Largest difference to every `stride`-th sample of a finer response, relative to its peak.
pub(crate) fn difference(coarse: &Response, fine: &Response, stride: usize) -> f64 {
    let peak = fine.peak_displacement();
    if peak == 0.0 {
        return if coarse.peak_displacement() == 0.0 { 0.0 } else { 1.0 };
    }
    let pairs = coarse.displacement.iter().zip(fine.displacement.iter().step_by(stride));
    pairs.fold(0.0, |most: f64, (a, b)| most.max((a - b).abs())) / peak
}

/// What a joint in sliders is held against: the continuum, or so many times finer sliders where it has none.
///
/// A slider whose friction drops begins to dissipate by a jump, so that D of a population is a staircase about that of the density and the
/// error falls with the inverse of their number: four times as many leave a quarter, which the difference is wrong by.
pub(crate) fn reference(mode: &Mode, joint: Representation) -> Representation {
    const FINER: usize = 4;
    match joint {
        Representation::Sliders { bins, grid } if mode.friction_drops() => {
            Representation::Sliders { bins: FINER * bins, grid }
        }
        _ => Representation::Continuum,
    }
}

/// Estimates for a Newmark run: time-step error by Richardson extrapolation from the double step (the
/// scheme's `order` 1 or 2), discretisation error against the continuum at that step.
///
/// A force from a file need not be smooth: what the steps do not see of it, and what double steps see less, is computed with the linear
/// mode ([`unseen`]), and the sliders are held against the continuum at the step itself.
pub(crate) fn of_newmark(
    (task, pulse): (Task<'_>, &Pulse<'_>),
    fine: &Response,
    scheme_at: impl Fn(f64) -> Result<Newmark, iwan_core::Error>,
    order: i32,
    joint: Representation,
) -> Result<Quality, SimulationError> {
    let mut quality = fine.quality;
    let unsmooth = matches!(pulse, Pulse::Sampled { .. });
    let (dt, samples) = (2.0 * task.dt, task.samples.div_ceil(2));
    let force = seen_by_double_steps(pulse, (task.dt, task.mode.shape_at_force), 0, task.force);
    let coarse = Task { force: &force, dt, samples, ..task };
    let linear = task.mode.joint.is_none();
    let finest = reference(task.mode, joint);
    quality.discretisation_error = (linear || joint == Representation::Continuum).then_some(0.0);
    // A prewarped double step may already be too long for the mode: then there is nothing to compare.
    let Some(scheme) = scheme_at(coarse.dt).ok().filter(|_| coarse.samples >= FEWEST) else {
        return Ok(quality);
    };
    let run = |task: Task<'_>, scheme: &Newmark, joint| {
        newmark(task, scheme, joint, Response::default(), UNWATCHED)
    };
    // A double step that does not work says nothing about the single one.
    let Ok(mut sliders) = run(coarse, &scheme, joint) else { return Ok(quality) };
    if quality.discretisation_error.is_none() {
        quality.discretisation_error = if unsmooth {
            run(task, &scheme_at(task.dt)?, finest).ok().map(|c| difference(fine, &c, 1))
        } else {
            run(coarse, &scheme, finest).ok().map(|c| difference(&sliders, &c, 1))
        };
    }
    let mut missed = 0.0;
    if let Pulse::Sampled { dt, samples } = pulse {
        let oscillator = task.mode.oscillator()?;
        let scale = task.mode.shape_at_force;
        let given = Polyline { dt: *dt, value: |i| scale * samples[i], count: samples.len(), ends: true };
        let seen = task.force;
        let steps = Polyline { dt: task.dt, value: |i| seen[i], count: seen.len(), ends: false };
        let twice = Polyline { dt: coarse.dt, value: |i| force[i], count: force.len(), ends: false };
        let left_out = unseen(&oscillator, given, steps).take(task.samples);
        missed = left_out.fold(0.0, largest) / fine.peak_displacement().max(f64::MIN_POSITIVE);
        let more = unseen(&oscillator, steps, twice);
        sliders.displacement.iter_mut().zip(more).for_each(|(q, more)| *q += more);
    }
    let steps = difference(&sliders, fine, 2) / f64::from(2_i32.pow(order.unsigned_abs()) - 1);
    quality.time_step_error = Some(steps + missed);
    Ok(quality)
}

fn largest(most: f64, x: f64) -> f64 {
    most.max(x.abs())
}
