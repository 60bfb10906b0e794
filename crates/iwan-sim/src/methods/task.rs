//! A run of one mode under a force, and what every such run needs.

use iwan_core::{Pulse, Slider};

use crate::error::SimulationError;
use crate::methods::between::as_the_file_does;
use crate::mode::Mode;
use crate::response::Response;

/// Number of steps between two calls of `progress`, and unit into which long runs are cut. At 3 to 25 ns a step they take 0.2 to 1.6 ms, so
/// that Ctrl-C acts at once and a bar moves, at a cost too small to measure. Any number from 2^12 to 2^20 does as well.
pub(crate) const CHUNK: usize = 1 << 16;

/// A run of one mode: force samples (modal, from t = 0, zero after the last) and time axis.
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

/// Force for a run whose steps are far finer than the response's. A force from a file is replaced by samples that act as the file does, so
/// that the remaining error falls with the square of the step. For such a force a second history is returned: the true force at the samples
/// less these samples, which must be added to the accelerations.
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

/// Adds `one` to `other`, from the start on.
pub(crate) fn add(one: &[f64], other: &mut [f64]) {
    other.iter_mut().zip(one).for_each(|(to, x)| *to += x);
}

/// The force, times `scale`, for companion runs in steps of `dt`: from their sample `first` on, at most `samples` samples.
///
/// A force given by a formula is sampled anew, so that an end between two steps is placed correctly for these steps, too. A force from a
/// file is replaced by the samples that act as the file does ([`as_the_file_does`]).
pub(crate) fn for_companions(
    force: &Pulse<'_>,
    (dt, scale): (f64, f64),
    first: usize,
    samples: usize,
) -> Vec<f64> {
    // The cubic of [`as_the_file_does`] reaches two samples beyond the end of the file's force.
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
    /// Table of sliders, if the joint is cut into sliders.
    pub(crate) table: Vec<Slider>,
    /// Number of reversals that are remembered, if the joint is a continuum.
    pub(crate) reversals: usize,
}

impl Room {
    /// Memory for the whole of a task.
    pub(crate) fn of(task: &Task<'_>) -> Self {
        let cycles = task.mode.frequency * task.dt * task.samples as f64;
        Self { table: Vec::new(), reversals: reversals(cycles, MOST) }
    }
}

/// Largest number of half cycles of a decay that are remembered (16 MB). Beyond it the smallest loops are forgotten, and the response
/// reports the bound of the force error.
pub(crate) const MOST: f64 = 1e6;

/// Number of reversals in `cycles` cycles: two per cycle of a decay, at most `most`, and some for the force.
pub(crate) fn reversals(cycles: f64, most: f64) -> usize {
    /// Reversals that a force may add to those of the decay. A pulse adds a few; if a long irregular force adds more, the smallest loops
    /// are forgotten, as above.
    const FORCED: usize = 64;
    FORCED + (2.0 * cycles).min(most) as usize
}

/// Index of the first sample at which a value is not finite.
pub(crate) fn first_not_finite([displacement, velocity, acceleration]: [&[f64]; 3]) -> Option<usize> {
    let bad = |n: &usize| ![displacement[*n], velocity[*n], acceleration[*n]].iter().all(|x| x.is_finite());
    (0..displacement.len()).find(bad)
}

/// Returns the response unless one of its values is not finite.
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
