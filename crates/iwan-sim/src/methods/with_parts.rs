//! A mode with parts beside its joint, or by its curves, in time steps.

use std::time::Instant;

use iwan_core::{
    Continuum, CurveNewmark, EnergyBalance, Motion, Newmark, NoJoint, Part, Progress, Representation, Run,
    Slider, Sliders, Trial, WithParts,
};

use crate::curves::Curves;
use crate::error::SimulationError;
use crate::joint_law::with_law;
use crate::methods::task::{CHUNK, Task, finite, stack};
use crate::response::{OutsideCurves, Response};

/// Average acceleration on a mode with parts.
pub(crate) fn newmark(
    task: Task<'_>,
    scheme: &Newmark,
    joint: Representation,
    spare: Response,
    progress: Progress<'_>,
) -> Result<Response, SimulationError> {
    let oscillator = task.mode.oscillator()?;
    let with = WithParts::new(scheme, &oscillator, &task.mode.parts)?;
    let run = Stepping { task, with, response: spare.cleared(task.dt, task.samples) };
    let Some(law) = &task.mode.joint else { return run.over(&NoJoint, 0.0, progress) };
    let mut response = match joint {
        Representation::Sliders { bins, grid } => {
            let mut table = vec![Slider::default(); Sliders::table_len(bins)];
            let sliders = with_law!(law, law => Sliders::discretise(law, grid, bins, &mut table))?;
            let state = sliders.virgin(vec![Run::default(); sliders.len()])?;
            run.over(&sliders, state, progress)?
        }
        Representation::Continuum => with_law!(law, law => {
            let joint = Continuum::new(law);
            let state = joint.virgin(stack(&task))?;
            run.over(&joint, state, progress)?
        }),
    };
    response.strongest = iwan_core::Backbone::strengths(law).1;
    Ok(response)
}

struct Stepping<'a> {
    task: Task<'a>,
    with: WithParts<'a>,
    /// Where the samples go.
    response: Response,
}

impl Stepping<'_> {
    /// Chunk by chunk, each with its energy balance.
    fn over<S, J: Trial<S>>(
        self,
        joint: &J,
        mut state: S,
        progress: Progress<'_>,
    ) -> Result<Response, SimulationError> {
        let Self { task, with, mut response } = self;
        let Task { mode, force, samples, .. } = task;
        joint.advance(&mut state, mode.initial.displacement);
        let mut velocity = mode.initial.velocity;
        let mut energy = None::<EnergyBalance>;
        let clock = Instant::now();
        in_chunks(samples, progress, |first, last| {
            let rest = force.get(first..).unwrap_or(&[]);
            let mut buffers = response.samples();
            let end = with.integrate(joint, &mut state, velocity, rest, &mut buffers.between(first, last))?;
            velocity = end.velocity;
            energy = Some(energy.map_or(end.energy, |before| before.then(&end.energy)));
            Ok(())
        })?;
        response.seconds = clock.elapsed().as_secs_f64();
        response.energy = energy.unwrap_or_default();
        finite(response).map_err(|error| {
            let softens = |part: &Part| matches!(part, Part::Spring(spring) if spring.k() < 0.0);
            match error {
                SimulationError::NotFinite { time } if mode.parts.iter().any(softens) => {
                    SimulationError::NoStiffness { time }
                }
                other => other,
            }
        })
    }
}

/// Average acceleration on a mode by its curves.
pub(crate) fn curves(
    task: Task<'_>,
    curves: &Curves,
    prewarp: bool,
    spare: Response,
    progress: Progress<'_>,
) -> Result<Response, SimulationError> {
    let Task { mode, force, dt, samples } = task;
    let stepper = CurveNewmark::new(curves.points(), dt, prewarp)?;
    let mut response = spare.cleared(dt, samples);
    let mut at = mode.initial;
    let mut energy = None::<EnergyBalance>;
    let clock = Instant::now();
    in_chunks(samples, progress, |first, last| {
        let rest = force.get(first..).unwrap_or(&[]);
        let mut buffers = response.samples();
        let end = stepper.integrate(at, rest, &mut buffers.between(first, last))?;
        at = end.motion;
        energy = Some(energy.map_or(end.energy, |before| before.then(&end.energy)));
        Ok(())
    })?;
    response.seconds = clock.elapsed().as_secs_f64();
    response.energy = energy.unwrap_or_default();
    within(curves, finite(response)?)
}

/// Runs over all samples a chunk at a time.
fn in_chunks(
    samples: usize,
    progress: Progress<'_>,
    mut chunk: impl FnMut(usize, usize) -> Result<(), iwan_core::Error>,
) -> Result<(), SimulationError> {
    let mut first = 0;
    loop {
        let last = (first + CHUNK).min(samples - 1);
        chunk(first, last)?;
        first = last;
        if progress(last as f64 / (samples - 1).max(1) as f64).is_break() {
            return Err(SimulationError::Interrupted);
        }
        if first == samples - 1 {
            return Ok(());
        }
    }
}

/// Says where a response left the mode's curves, and refuses one that went beyond them without leave.
pub(crate) fn within(curves: &Curves, mut response: Response) -> Result<Response, SimulationError> {
    /// Rounding of an amplitude, in shares of itself: a release at the largest amplitude itself is within.
    const ROUNDING: f64 = 1e-12;
    let (smallest, largest) = curves.points().range();
    let (mut above, mut last_within) = (None::<Motion>, None);
    let mut outside = OutsideCurves::default();
    for (n, (&displacement, &velocity)) in response.displacement.iter().zip(&response.velocity).enumerate() {
        let amplitude = curves.points().amplitude(displacement, velocity);
        if amplitude >= smallest {
            last_within = Some(n);
        }
        if amplitude > largest * (1.0 + ROUNDING) {
            above.get_or_insert(Motion { displacement, velocity });
            outside.above_from.get_or_insert(n as f64 * response.dt);
            outside.largest_amplitude = outside.largest_amplitude.max(amplitude);
        }
    }
    if let Some(time) = outside.above_from.filter(|_| !curves.extrapolates()) {
        return Err(SimulationError::BeyondCurves { amplitude: outside.largest_amplitude, largest, time });
    }
    let below = last_within.map_or(0, |n| n + 1);
    outside.below_from = (below < response.displacement.len()).then_some(below as f64 * response.dt);
    response.quality.outside_curves = outside;
    Ok(response)
}
