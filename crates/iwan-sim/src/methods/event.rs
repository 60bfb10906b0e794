//! The event-driven reference method for one mode.

use std::time::Instant;

use iwan_core::progress::{Progress, UNWATCHED};
use iwan_core::{
    Backbone, EventDriven, Grid, Hysteresis, Jenkins, Newmark, Pulse, Representation, Run, Slider, Sliders,
};

use crate::error::SimulationError;
use crate::joint_law::with_law;
use crate::methods::quality;
use crate::methods::run::newmark;
use crate::methods::task::{Task, finite};
use crate::response::{Quality, Response};

/// Angle of the series in the companion run that estimates the error, as a share of the angle in the run itself. The companion's series
/// must begin at other times than those of the run: with a share of 1 both would be identical at long output intervals, and the estimate
/// would be 0. From 0.3 to 0.95 the two differ by the same few 1e-15.
const COMPANION: f64 = 0.62;

/// Number of bins and grid of the sliders.
#[derive(Clone, Copy)]
pub(crate) struct Cut {
    pub(crate) bins: usize,
    pub(crate) grid: Grid,
}

/// Stiffness (1/s²) and slip force of the slider that stands in for the joint of a linear mode. It is so weak that it adds nothing to any
/// mode and so strong that it never slips, and neither the product nor the quotient of the two numbers overflows.
const NO_JOINT: [f64; 2] = [1e-150, 1e150];

/// Event-driven run; with error estimates if `wanted`.
pub(crate) fn simulate(
    task: Task<'_>,
    force: &Pulse<'_>,
    cut: Cut,
    wanted: bool,
    progress: Progress<'_>,
) -> Result<Response, SimulationError> {
    let mut response = run(task, force, cut, None)?;
    if progress(0.5).is_break() {
        return Err(SimulationError::Interrupted);
    }
    if wanted {
        let angle = (2.0 * std::f64::consts::PI * task.mode.frequency * task.dt).min(0.5);
        let companion = run(task, force, cut, Some(COMPANION * angle))?;
        response.quality = Quality {
            time_step_error: Some(quality::difference(&companion, &response, 1)),
            discretisation_error: discretisation(
                task,
                Representation::Sliders { bins: cut.bins, grid: cut.grid },
            )?,
            ..Quality::default()
        };
    }
    if progress(1.0).is_break() {
        return Err(SimulationError::Interrupted);
    }
    Ok(response)
}

fn run(
    task: Task<'_>,
    force: &Pulse<'_>,
    Cut { bins, grid }: Cut,
    angle: Option<f64>,
) -> Result<Response, SimulationError> {
    let Task { mode, dt, samples, .. } = task;
    let oscillator = mode.oscillator()?;
    let mut table = vec![Slider::default(); Sliders::table_len(bins)];
    let sliders = if let Some(law) = &mode.joint {
        with_law!(law, law => Sliders::discretise(law, grid, bins, &mut table))?
    } else {
        let [stiffness, slip_force] = NO_JOINT;
        Sliders::discretise(&Jenkins::new(stiffness, slip_force)?, grid, bins, &mut table)?
    };
    let mut state = sliders.virgin(vec![Run::default(); sliders.len()])?;
    sliders.advance(&mut state, mode.initial.displacement);
    let mut solver = EventDriven::new(&oscillator, sliders, *force, mode.shape_at_force)?;
    if let Some(angle) = angle {
        solver = solver.with_angle(angle)?;
    }
    let mut response = Response::zeros(dt, samples);
    let clock = Instant::now();
    let energy = solver.integrate(&mut state, mode.initial.velocity, dt, &mut response.samples())?;
    response.seconds = clock.elapsed().as_secs_f64();
    response.energy = energy;
    response.strongest = mode.joint.as_ref().map_or(f64::INFINITY, |law| law.strengths().1);
    finite(response)
}

/// Difference between sliders and the continuum, both by Newmark's method at the sampling interval; none if that interval is too long for
/// the mode.
fn discretisation(task: Task<'_>, joint: Representation) -> Result<Option<f64>, SimulationError> {
    if task.mode.joint.is_none() {
        return Ok(Some(0.0));
    }
    let Ok(scheme) = Newmark::prewarped(task.dt, task.mode.oscillator()?.omega0()) else { return Ok(None) };
    let run = |joint| newmark(task, &scheme, joint, Response::default(), UNWATCHED);
    let pair = run(joint).and_then(|sliders| Ok((sliders, run(Representation::Continuum)?)));
    Ok(pair.ok().map(|(sliders, continuum)| quality::difference(&sliders, &continuum, 1)))
}
