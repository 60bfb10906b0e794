//! One mode by Newmark's method, without checks of the input.

use std::time::Instant;

use iwan_core::{Backbone, EnergyBalance, Newmark, Part, Progress, Representation};

use crate::error::SimulationError;
use crate::methods::outside;
use crate::methods::stepped;
use crate::methods::task::{CHUNK, Room, Task, finite};
use crate::mode::Mode;
use crate::response::Response;

/// Newmark's scheme with the joint in the given representation; the buffers of `spare` are reused.
pub(crate) fn newmark(
    task: Task<'_>,
    scheme: &Newmark,
    joint: Representation,
    spare: Response,
    progress: Progress<'_>,
) -> Result<Response, SimulationError> {
    let Task { mode, force, samples, .. } = task;
    let mut room = Room::of(&task);
    let mut stepped = stepped::begin(task, scheme, joint, &mut room)?;
    let mut response = spare.cleared(task.dt, samples);
    let mut energy = None::<EnergyBalance>;
    let clock = Instant::now();
    let mut first = 0;
    loop {
        let last = (first + CHUNK).min(samples - 1);
        let rest = force.get(first..).unwrap_or(&[]);
        let mut buffers = response.samples();
        let mut stretch = buffers.between(first, last);
        stepped.advance(rest, &mut stretch)?;
        let end = stepped.balance(rest, &stretch);
        energy = Some(energy.map_or(end, |before| before.then(&end)));
        first = last;
        if progress(last as f64 / (samples - 1).max(1) as f64).is_break() {
            return Err(SimulationError::Interrupted);
        }
        if first == samples - 1 {
            break;
        }
    }
    response.seconds = clock.elapsed().as_secs_f64();
    response.energy = energy.unwrap_or_default();
    response.quality.forgotten_force = stepped.forgotten();
    response.strongest = strongest(mode);
    let response = finite(response).map_err(|error| told(mode, error))?;
    match &mode.curves {
        Some(curves) => outside::within(curves, response),
        None => Ok(response),
    }
}

/// Strength of the mode's strongest slider; infinite without a joint.
pub(crate) fn strongest(mode: &Mode) -> f64 {
    let law = mode.joint.as_ref().filter(|_| mode.curves.is_none());
    law.map_or(f64::INFINITY, |law| law.strengths().1)
}

/// The reason why a response is not finite: a softening spring, if the mode has one.
pub(crate) fn told(mode: &Mode, error: SimulationError) -> SimulationError {
    let softens = |part: &Part| matches!(part, Part::Spring(spring) if spring.k() < 0.0);
    match error {
        SimulationError::NotFinite { time } if mode.parts.iter().any(softens) => {
            SimulationError::NoStiffness { time }
        }
        other => other,
    }
}
