//! What is run: one mode under a force, and what every run of it needs.

use iwan_core::{Pulse, Slider};

use crate::error::SimulationError;
use crate::methods::between::as_the_file_does;
use crate::mode::Mode;
use crate::response::Response;

/// Steps between two calls of `progress`, the unit in which long runs are cut: at 3 to 25 ns a step 0.2 to 1.6 ms,
/// so that Ctrl-C is heard at once and a bar moves, at a cost that cannot be measured. Any number from 2^12 to 2^20
/// does as well.
pub(crate) const CHUNK: usize = 1 << 16;

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
    let mut history = sampled(force, dt, samples);
    for p in &mut history {
        *p *= mode.shape_at_force;
    }
    history
}

/// The force at the samples, up to the last one that is not zero.
pub(crate) fn sampled(force: &Pulse<'_>, dt: f64, samples: usize) -> Vec<f64> {
    let settled = (force.settled() / dt).min(samples as f64) as usize + 2;
    let constant = force.at(force.settled() + dt) != 0.0;
    let mut history = vec![0.0; if constant { samples } else { settled.min(samples) }];
    let used = force.sample(dt, &mut history);
    history.truncate(used);
    history
}

/// Force of a run whose steps are far finer than the response's: as the file does where it is from a file, so that what is left falls with the square of the step.
/// With it goes what an acceleration at a sample lacks then, the force there less what does as the file does.
pub(crate) fn stepped_finely(
    mode: &Mode,
    force: &Pulse<'_>,
    dt: f64,
    samples: usize,
) -> (Vec<f64>, Option<Vec<f64>>) {
    let scale = mode.shape_at_force;
    let stepped = for_companions(force, (dt, scale), 0, samples);
    let lacking = matches!(force, Pulse::Sampled { .. }).then(|| {
        let mut itself = modal_force(mode, force, dt, samples);
        itself.resize(stepped.len().max(itself.len()), 0.0);
        itself.iter_mut().zip(&stepped).for_each(|(p, stepped)| *p -= stepped);
        itself
    });
    (stepped, lacking)
}

/// Adds one history to another from the start on.
pub(crate) fn add(one: &[f64], other: &mut [f64]) {
    other.iter_mut().zip(one).for_each(|(to, x)| *to += x);
}

/// The force, times `scale`, as companion runs see it in steps of `dt`, from their sample `first` on and over at most so many samples.
///
/// A force by a formula is sampled anew, so that where it stops between two steps its end is in its place for these steps, too. One from a file is told by the
/// samples that do as the file does ([`as_the_file_does`]).
pub(crate) fn for_companions(
    force: &Pulse<'_>,
    (dt, scale): (f64, f64),
    first: usize,
    samples: usize,
) -> Vec<f64> {
    // A cubic reaches two samples beyond the file's end.
    let reach = ((force.settled() / dt) as usize).saturating_add(3);
    let constant = force.at(force.settled() + dt) != 0.0;
    let room = if constant { samples } else { samples.min(reach.saturating_sub(first)) };
    let mut history = vec![0.0; room];
    let used = as_the_file_does(force, dt, first, &mut history)
        .unwrap_or_else(|| force.sample_from(first, dt, &mut history));
    history.truncate(used);
    for p in &mut history {
        *p *= scale;
    }
    history
}

/// Memory that a run borrows.
#[derive(Debug, Default)]
pub(crate) struct Room {
    /// Sliders, where the joint is cut into some.
    pub(crate) table: Vec<Slider>,
    /// Number of reversals that are remembered, where it is not.
    pub(crate) reversals: usize,
}

impl Room {
    /// For the whole of a task.
    pub(crate) fn of(task: &Task<'_>) -> Self {
        let cycles = task.mode.frequency * task.dt * task.samples as f64;
        Self { table: Vec::new(), reversals: reversals(cycles, MOST) }
    }
}

/// Half cycles of a decay that are all remembered (16 MB). Behind them the smallest loops are forgotten, and
/// the response says how much force that may have cost.
pub(crate) const MOST: f64 = 1e6;

/// Number of reversals of so many cycles: two a cycle in a decay, at most so many, and some for the force.
pub(crate) fn reversals(cycles: f64, most: f64) -> usize {
    /// Reversals that a force may add to those of the decay. A pulse makes a few; should a long irregular force
    /// make more, the smallest loops go, as above.
    const FORCED: usize = 64;
    FORCED + (2.0 * cycles).min(most) as usize
}

/// Number of the first sample with a value that is not finite.
pub(crate) fn first_not_finite([displacement, velocity, acceleration]: [&[f64]; 3]) -> Option<usize> {
    let bad = |n: &usize| ![displacement[*n], velocity[*n], acceleration[*n]].iter().all(|x| x.is_finite());
    (0..displacement.len()).find(bad)
}

/// Passes a response on unless NaN or infinity crept in.
pub(crate) fn finite(response: Response) -> Result<Response, SimulationError> {
    let motion = [&response.displacement, &response.velocity, &response.acceleration].map(Vec::as_slice);
    match first_not_finite(motion) {
        None if !response.energy.scale.is_finite() || !response.energy.residual.is_finite() => {
            Err(SimulationError::NotFinite { time: 0.0 })
        }
        Some(n) => Err(SimulationError::NotFinite { time: n as f64 * response.dt }),
        None => Ok(response),
    }
}
