//! What is run: one mode under a force, and what every run of it needs.

use iwan_core::{Pulse, Reversal};

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

/// Room for the reversals of a run: two a cycle in a decay, at the highest frequency the mode has, and some for the
/// force.
pub(crate) fn stack(task: &Task<'_>) -> Vec<Reversal> {
    reversals(task.mode.frequency * task.dt * task.samples as f64)
}

/// The same for so many cycles.
pub(crate) fn reversals(cycles: f64) -> Vec<Reversal> {
    /// Half cycles of a decay that are all remembered (16 MB). Behind them the smallest loops are forgotten, and
    /// the response says how much force that may have cost.
    const MOST: f64 = 1e6;
    /// Reversals that a force may add to those of the decay. A pulse makes a few; should a long irregular force
    /// make more, the smallest loops go, as above.
    const FORCED: usize = 64;
    vec![Reversal::default(); FORCED + (2.0 * cycles).min(MOST) as usize]
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
