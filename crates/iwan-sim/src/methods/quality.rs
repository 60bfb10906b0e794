//! Error estimates from companion runs at twice the time step.

use iwan_core::progress::UNWATCHED;
use iwan_core::{Newmark, Pulse, Representation};

use crate::error::SimulationError;
use crate::methods::between;
use crate::methods::run::newmark;
use crate::methods::task::{Task, for_companions};
use crate::mode::Mode;
use crate::response::{Quality, Response};

/// Shortest response, in samples of the companion run, that gets an estimate. Over fewer points the largest difference means little,
/// because they may all lie where two wrong responses cross. The number is arbitrary; responses of practical interest are longer.
pub(crate) const FEWEST: usize = 8;

/// An error of displacement relative to a peak. If the peak is 0, the result is 0 for no error and 1 for any other.
pub(crate) fn relative(error: f64, peak: f64) -> f64 {
    if peak == 0.0 { f64::from(u8::from(error != 0.0)) } else { error / peak }
}

/// Largest difference between a response and every `stride`-th sample of a finer one, relative to the finer one's peak.
pub(crate) fn difference(coarse: &Response, fine: &Response, stride: usize) -> f64 {
    let pairs = coarse.displacement.iter().zip(fine.displacement.iter().step_by(stride));
    let most = pairs.fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
    relative(most, fine.peak_displacement())
}

/// Error of time steps relative to the peak, from steps twice as long and, under a force from a file, from a run that acts as the file's
/// force does ([`between::error`]).
pub(crate) fn step_error(fine: &Response, whole: Option<&Response>, double: &Response, divisor: f64) -> f64 {
    let [steps, whole, double] = [fine, whole.unwrap_or(fine), double].map(|run| &run.displacement[..]);
    relative(between::error(steps, whole, double, divisor), fine.peak_displacement())
}

/// The representation with which a joint on sliders is compared: the continuum, or four times as many sliders where the law has no
/// continuum.
///
/// A slider whose friction drops begins to dissipate with a jump. So the dissipation of a population is a staircase about that of the
/// density, and its error falls with the inverse number of sliders: four times as many leave a quarter, by which the estimate is wrong.
pub(crate) fn reference(mode: &Mode, joint: Representation) -> Representation {
    const FINER: usize = 4;
    match joint {
        Representation::Sliders { bins, grid } if mode.friction_drops() => {
            Representation::Sliders { bins: FINER * bins, grid }
        }
        _ => Representation::Continuum,
    }
}

/// Error estimates for a Newmark run: the time-step error by Richardson extrapolation from the double step (the scheme has the `order` 1 or
/// 2), the discretisation error against the continuum at the double step.
///
/// A force from a file need not be smooth. The part of it that the steps miss is found by a run of the same steps that acts as the file's
/// force does ([`as_the_file_does`](super::between::as_the_file_does)). The double steps then act as the file does, too, and sliders are
/// compared with the continuum at the single step.
pub(crate) fn of_newmark(
    (task, pulse): (Task<'_>, &Pulse<'_>),
    fine: &Response,
    scheme_at: impl Fn(f64) -> Result<Newmark, iwan_core::Error>,
    order: i32,
    joint: Representation,
) -> Result<Quality, SimulationError> {
    let mut quality = fine.quality;
    let (mode, dt, samples) = (task.mode, 2.0 * task.dt, task.samples.div_ceil(2));
    let unsmooth = matches!(pulse, Pulse::Sampled { .. });
    let force = for_companions(pulse, (dt, mode.shape_at_force), 0, samples);
    let coarse = Task { force: &force, dt, samples, ..task };
    let linear = mode.joint.is_none();
    let finest = reference(mode, joint);
    quality.discretisation_error = (linear || joint == Representation::Continuum).then_some(0.0);
    // A prewarped double step may be too long for the mode; then there is no estimate.
    let Some(scheme) = scheme_at(coarse.dt).ok().filter(|_| coarse.samples >= FEWEST) else {
        return Ok(quality);
    };
    let run = |task: Task<'_>, scheme: &Newmark, joint| {
        newmark(task, scheme, joint, Response::default(), UNWATCHED)
    };
    // A double step that fails says nothing about the single step, so there is no estimate.
    let Ok(double) = run(coarse, &scheme, joint) else { return Ok(quality) };
    if quality.discretisation_error.is_none() {
        quality.discretisation_error = if unsmooth {
            run(task, &scheme_at(task.dt)?, finest).ok().map(|c| difference(fine, &c, 1))
        } else {
            run(coarse, &scheme, finest).ok().map(|c| difference(&double, &c, 1))
        };
    }
    let divisor = f64::from(2_i32.pow(order.unsigned_abs()) - 1);
    let whole = if unsmooth {
        let force = for_companions(pulse, (task.dt, mode.shape_at_force), 0, task.samples);
        run(Task { force: &force, ..task }, &scheme_at(task.dt)?, joint).ok()
    } else {
        None
    };
    let told = !unsmooth || whole.is_some();
    quality.time_step_error = told.then(|| step_error(fine, whole.as_ref(), &double, divisor));
    Ok(quality)
}
