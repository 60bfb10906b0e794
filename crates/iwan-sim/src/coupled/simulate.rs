//! Simulation of modes that share joints.

use iwan_core::progress::{Progress, UNWATCHED, part};
use iwan_core::{Error, Pulse, Representation};

use super::joint::{SharedJoint, check_rows};
use super::response::CoupledResponse;
use super::run::newmark;
use super::task::{Task, parted};
use crate::error::SimulationError;
use crate::methods::quality::{difference, step_error};
use crate::methods::task::{for_companions, sampled};
use crate::mode::Mode;
use crate::response::Response;
use crate::settings::{Method, Settings};
use crate::simulate::{check_scales, simulate_all};

/// Simulates modes of which some share joints, under the physical `force`; a mode's `shape_at_force` makes it a modal force. A mode that
/// moves no shared joint is simulated by itself, on up to `threads` threads.
///
/// The frequency of each mode is its frequency with all joints stuck. The equations are those of `iwan_core::CoupledModes`.
///
/// ```
/// use iwan_core::{FourParameter, Pulse, progress::UNWATCHED};
/// use iwan_sim::{JointLaw, Mode, Settings, SharedJoint, simulate_coupled};
/// let law = JointLaw::FourParameter(FourParameter::new(3.16e4, 143.8, -0.3, 0.02)?);
/// let modes = [Mode::new("bending 1", 132.35, None), Mode::new("bending 3", 719.6, None)];
/// let joint = SharedJoint { compliance: vec![9.1e-6], ..SharedJoint::new("link", law, vec![1.0, -4.905], 1) };
/// let blow = Pulse::Haversine { amplitude: 7000.0, duration: 1.6e-3 };
/// let response = simulate_coupled(&modes, &[joint], &blow, &Settings::new(1e-5, 0.05), 1, UNWATCHED)?;
/// assert!(response.energy.error() < 1e-13);
/// assert!(response.joints[0].slip_ratio() > 0.1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`SimulationError::Joint`] and [`SimulationError::Mode`] with the name of the joint or mode whose value is out of range or does not fit;
/// [`SimulationError::Parameter`] for joints for which a step has no unique solution or which no stiffness holds, and for methods other
/// than Newmark's average acceleration; [`SimulationError::NotFinite`] on overflow; [`SimulationError::Interrupted`] when `progress`
/// returned `Break`.
pub fn simulate_coupled(
    modes: &[Mode],
    joints: &[SharedJoint],
    force: &Pulse<'_>,
    settings: &Settings,
    threads: usize,
    progress: Progress<'_>,
) -> Result<CoupledResponse, SimulationError> {
    let force = force.checked()?;
    let (dt, samples) = (settings.dt, settings.samples()?);
    settings.ask(modes.len(), 2 * joints.len())?;
    check_rows(modes, joints)?;
    let [coupled, alone] = parted(modes, joints);
    let (prewarp, representation) = of_method(settings.method)?;
    for mode in coupled.iter().map(|r| &modes[*r]) {
        check_scales(mode, &force, settings)?;
    }
    let mut whole = CoupledResponse::default();
    if !coupled.is_empty() {
        let history = sampled(&force, dt, samples);
        let task = Task::new(modes, &coupled, joints, (&history, dt, samples))?;
        task.check(prewarp)?;
        whole = newmark(&task, prewarp, representation, &part(progress, [0.0, 0.6]))?;
        let forgotten = whole.joints.iter().map(|joint| joint.forgotten_force);
        whole.quality.forgotten_force = forgotten.fold(0.0, f64::max);
        if settings.quality {
            let progress = part(progress, [0.6, 0.9]);
            estimate((&task, &force), &mut whole, (prewarp, representation), &progress)?;
        }
    }
    let lonely: Vec<Mode> = alone.iter().map(|r| modes[*r].clone()).collect();
    let by_themselves = simulate_all(&lonely, &force, settings, threads, &part(progress, [0.9, 1.0]))?;
    let mut ordered: Vec<(usize, Response)> =
        coupled.into_iter().zip(whole.modes).chain(alone.into_iter().zip(by_themselves)).collect();
    ordered.sort_by_key(|(r, _)| *r);
    whole.modes = ordered.into_iter().map(|(_, response)| response).collect();
    Ok(whole)
}

/// Checks that modes, joints and settings can be simulated, without simulating.
///
/// # Errors
/// The errors of [`simulate_coupled`] that occur before its first step.
pub fn check_coupled(
    modes: &[Mode],
    joints: &[SharedJoint],
    settings: &Settings,
) -> Result<(), SimulationError> {
    check_rows(modes, joints)?;
    let (prewarp, _) = of_method(settings.method)?;
    let [coupled, _] = parted(modes, joints);
    if !coupled.is_empty() {
        Task::new(modes, &coupled, joints, (&[], settings.dt, settings.samples()?))?.check(prewarp)?;
    }
    Ok(())
}

/// Whether the method prewarps, and its representation of joints.
fn of_method(method: Method) -> Result<(bool, Representation), Error> {
    let what = match method {
        Method::Newmark { beta: 0.25, gamma: 0.5, prewarp, joint } => return Ok((prewarp, joint)),
        Method::Newmark { .. } => "modes that share joints are stepped with beta = 0.25 and gamma = 0.5 only",
        Method::HalfCycle | Method::Averaging | Method::Event { .. } => {
            "half-cycle, averaging and event run one mode at a time: modes that share joints need newmark"
        }
    };
    Err(Error::Unsupported { what })
}

/// Shortest response, in samples of the companion run, that gets an estimate; the same number as for a mode by itself.
const FEWEST: usize = 8;

/// Time-step error by Richardson extrapolation from the double step; discretisation error against the continuum at the double step. Under a
/// force from a file, estimates are made as for a mode by itself.
fn estimate(
    (task, force): (&Task<'_>, &Pulse<'_>),
    response: &mut CoupledResponse,
    (prewarp, joint): (bool, Representation),
    progress: Progress<'_>,
) -> Result<(), SimulationError> {
    let exact = joint == Representation::Continuum;
    let unsmooth = matches!(force, Pulse::Sampled { .. });
    let (dt, samples) = (2.0 * task.dt, task.samples.div_ceil(2));
    let seen = for_companions(force, (dt, 1.0), 0, samples);
    let coarse = task.beside((&seen, dt, samples));
    let run = |task: &Task<'_>, joint| newmark(task, prewarp, joint, UNWATCHED);
    // A double step that fails says nothing about the single step, so there is no estimate.
    let double = if samples < FEWEST { None } else { run(&coarse, joint).ok() };
    if progress(0.3).is_break() {
        return Err(SimulationError::Interrupted);
    }
    let beside = if unsmooth { task } else { &coarse };
    let continuum = match double {
        Some(_) if !exact => run(beside, Representation::Continuum).ok(),
        _ => None,
    };
    if progress(0.6).is_break() {
        return Err(SimulationError::Interrupted);
    }
    let whole = if unsmooth && double.is_some() {
        let seen = for_companions(force, (task.dt, 1.0), 0, task.samples);
        run(&task.beside((&seen, task.dt, task.samples)), joint).ok()
    } else {
        None
    };
    if progress(1.0).is_break() {
        return Err(SimulationError::Interrupted);
    }
    for (r, mode) in response.modes.iter_mut().enumerate() {
        let fine = &*mode;
        let cut = double.as_ref().zip(continuum.as_ref()).map(|(double, continuum)| {
            let against = if unsmooth { fine } else { &double.modes[r] };
            difference(against, &continuum.modes[r], 1)
        });
        let told = double.as_ref().filter(|_| !unsmooth || whole.is_some());
        let time_step =
            told.map(|double| step_error(fine, whole.as_ref().map(|w| &w.modes[r]), &double.modes[r], 3.0));
        mode.quality.time_step_error = time_step;
        mode.quality.discretisation_error = if exact { Some(0.0) } else { cut };
    }
    let worst = |of: fn(&Response) -> Option<f64>| {
        response.modes.iter().map(of).try_fold(0.0_f64, |most, error| Some(most.max(error?)))
    };
    response.quality.time_step_error = worst(|mode| mode.quality.time_step_error);
    response.quality.discretisation_error = worst(|mode| mode.quality.discretisation_error);
    Ok(())
}
