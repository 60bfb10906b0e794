//! One mode, one method, no questions asked.

use std::time::Instant;

use iwan_core::{
    Backbone, Continuum, Error, Hysteresis, JointEnergy, Newmark, NoJoint, Oscillator, Progress, Pulse,
    Representation, Reversal, Run, Samples, Slider, Sliders, TabledFourParameter,
};

use crate::error::SimulationError;
use crate::joint_law::JointLaw;
use crate::joint_law::with_law;
use crate::mode::Mode;
use crate::response::Response;

/// Steps between two calls of `progress`, the unit in which long runs are cut: at 3 to 25 ns a step 0.2 to 1.6 ms,
/// so that Ctrl-C is heard at once and a bar moves, at a cost that cannot be measured. Any number from 2^12 to 2^20
/// does as well.
const CHUNK: usize = 1 << 16;

/// A run of one mode: force samples (modal, from t = 0, zero behind the last) and time axis.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Task<'a> {
    pub(crate) mode: &'a Mode,
    pub(crate) force: &'a [f64],
    pub(crate) dt: f64,
    pub(crate) samples: usize,
}

/// The modal force at the samples, up to the last one that is not zero.
pub(crate) fn modal_force(mode: &Mode, force: &Pulse<'_>, dt: f64, samples: usize) -> Vec<f64> {
    let settled = (force.settled() / dt).min(samples as f64) as usize + 2;
    let constant = force.at(force.settled() + dt) != 0.0;
    let mut history = vec![0.0; if constant { samples } else { settled.min(samples) }];
    let used = force.sample(dt, &mut history);
    history.truncate(used);
    for p in &mut history {
        *p *= mode.shape_at_force;
    }
    history
}

/// Newmark's scheme on a joint represented as asked, in the buffers of `spare`.
pub(crate) fn newmark(
    task: Task<'_>,
    scheme: &Newmark,
    joint: Representation,
    spare: Response,
    progress: Progress<'_>,
) -> Result<Response, SimulationError> {
    let oscillator = task.mode.oscillator()?;
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

/// Room for the reversals of a run: two a cycle in a decay, at the highest frequency the mode has, and some for the
/// force.
pub(crate) fn stack(task: &Task<'_>) -> Vec<Reversal> {
    /// Half cycles of a decay that are all remembered (16 MB). Behind them the smallest loops are forgotten, and
    /// the response says how much force that may have cost.
    const MOST: f64 = 1e6;
    /// Reversals that a force may add to those of the decay. A pulse makes a few; should a long irregular force
    /// make more, the smallest loops go, as above.
    const FORCED: usize = 64;
    let half_cycles = 2.0 * task.mode.frequency * task.dt * task.samples as f64;
    vec![Reversal::default(); FORCED + half_cycles.min(MOST) as usize]
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

/// Passes a response on unless NaN or infinity crept in.
pub(crate) fn finite(response: Response) -> Result<Response, SimulationError> {
    let bad = |n: &usize| {
        let values = [response.displacement[*n], response.velocity[*n], response.acceleration[*n]];
        !values.iter().all(|x| x.is_finite())
    };
    match (0..response.displacement.len()).find(bad) {
        None if !response.energy.scale.is_finite() || !response.energy.residual.is_finite() => {
            Err(SimulationError::NotFinite { time: 0.0 })
        }
        Some(n) => Err(SimulationError::NotFinite { time: n as f64 * response.dt }),
        None => Ok(response),
    }
}
