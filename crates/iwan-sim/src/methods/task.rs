//! What is run: one mode under a force, and what every run of it needs.

use iwan_core::{Pulse, Slider};

use crate::error::SimulationError;
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

/// The force as steps twice as long see it, from their sample `first` / 2 on, where the steps see `seen` from `first` on, in time and force
/// scaled by `(dt, scale)`.
///
/// A force by a formula is sampled anew, so that where it stops between two steps its end is in its place for these, too. What a file holds
/// between samples is found apart ([`unseen`](super::between::unseen)): of its samples every other is taken.
pub(crate) fn seen_by_double_steps(
    force: &Pulse<'_>,
    (dt, scale): (f64, f64),
    first: usize,
    seen: &[f64],
) -> Vec<f64> {
    if matches!(force, Pulse::Sampled { .. }) {
        return seen.iter().copied().step_by(2).collect();
    }
    let mut history = vec![0.0; seen.len().div_ceil(2)];
    let used = force.sample_from(first / 2, 2.0 * dt, &mut history);
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
