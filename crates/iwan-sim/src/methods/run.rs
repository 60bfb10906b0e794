//! One mode by Newmark's method, no questions asked.

use std::time::Instant;

use iwan_core::{
    Backbone, Continuum, Error, Hysteresis, JointEnergy, Newmark, NoJoint, Oscillator, Progress,
    Representation, Reversal, Run, Samples, Slider, Sliders, TabledFourParameter,
};

use crate::error::SimulationError;
use crate::joint_law::JointLaw;
use crate::joint_law::with_law;
use crate::methods::task::{CHUNK, Task, finite, stack};
use crate::methods::with_parts;
use crate::response::Response;

/// Newmark's scheme on a joint represented as asked, in the buffers of `spare`.
pub(crate) fn newmark(
    task: Task<'_>,
    scheme: &Newmark,
    joint: Representation,
    spare: Response,
    progress: Progress<'_>,
) -> Result<Response, SimulationError> {
    let oscillator = task.mode.oscillator()?;
    if let Some(curves) = &task.mode.curves {
        return with_parts::curves(task, curves, scheme.is_prewarped(), spare, progress);
    }
    if !task.mode.parts.is_empty() {
        return with_parts::newmark(task, scheme, joint, spare, progress);
    }
    let response = spare.cleared(task.dt, task.samples);
    let stepping = Stepping { task, scheme, oscillator, response };
    let Some(law) = &task.mode.joint else {
        return stepping.run(
            &NoJoint,
            0.0,
            |j, s, v, f, out| scheme.integrate(&oscillator, j, s, v, f, out),
            progress,
        );
    };
    let mut response = match joint {
        Representation::Sliders { bins, grid } => {
            let mut table = vec![Slider::default(); Sliders::table_len(bins)];
            let sliders = with_law!(law, law => Sliders::discretise(law, grid, bins, &mut table))?;
            let state = sliders.virgin(vec![Run::default(); sliders.len()])?;
            stepping.run(
                &sliders,
                state,
                |j, s, v, f, out| scheme.integrate_sliders(&oscillator, j, s, v, f, out),
                progress,
            )?
        }
        Representation::Continuum => match law {
            JointLaw::FourParameter(law) => stepping.continuum(TabledFourParameter::new(*law), progress)?,
            law => with_law!(law, law => stepping.continuum(law, progress))?,
        },
    };
    response.strongest = law.strengths().1;
    Ok(response)
}

struct Stepping<'a> {
    task: Task<'a>,
    scheme: &'a Newmark,
    oscillator: Oscillator,
    /// Where the samples go.
    response: Response,
}

impl Stepping<'_> {
    fn continuum<B: Backbone>(self, law: B, progress: Progress<'_>) -> Result<Response, SimulationError> {
        let joint = Continuum::new(law);
        let mut forgotten = 0.0;
        let state = joint.virgin(stack(&self.task))?;
        let (scheme, oscillator) = (self.scheme, self.oscillator);
        let step = |j: &Continuum<B>,
                    s: &mut iwan_core::Reversals<Vec<Reversal>>,
                    v,
                    f: &[f64],
                    out: &mut Samples<'_>| {
            let end = scheme.integrate(&oscillator, j, s, v, f, out);
            forgotten = s.forgotten();
            end
        };
        let mut response = self.run(&joint, state, step, progress)?;
        response.quality.forgotten_force = forgotten;
        Ok(response)
    }

    /// Integrates chunk by chunk, balances the energy and checks that all is finite.
    fn run<S, J: Hysteresis<S>>(
        self,
        joint: &J,
        mut state: S,
        mut step: impl FnMut(&J, &mut S, f64, &[f64], &mut Samples<'_>) -> Result<f64, Error>,
        progress: Progress<'_>,
    ) -> Result<Response, SimulationError> {
        let Task { mode, force, samples, .. } = self.task;
        let mut response = self.response;
        joint.advance(&mut state, mode.initial.displacement);
        let (start, mut velocity) = (joint.stored_energy(&state), mode.initial.velocity);
        let clock = Instant::now();
        let mut first = 0;
        loop {
            let last = (first + CHUNK).min(samples - 1);
            let rest = force.get(first..).unwrap_or(&[]);
            velocity = step(joint, &mut state, velocity, rest, &mut response.samples().between(first, last))?;
            first = last;
            if progress(last as f64 / (samples - 1).max(1) as f64).is_break() {
                return Err(SimulationError::Interrupted);
            }
            if first == samples - 1 {
                break;
            }
        }
        response.seconds = clock.elapsed().as_secs_f64();
        let stored = JointEnergy { start, end: joint.stored_energy(&state) };
        response.energy = self.scheme.energy(&self.oscillator, stored, force, &response.samples());
        finite(response)
    }
}
