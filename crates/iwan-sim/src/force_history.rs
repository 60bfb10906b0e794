//! Force of a single joint that is driven through given displacements.

use iwan_core::{
    Backbone, Continuum, Error, Hysteresis, Progress, Representation, Reversal, Run, Slider, Sliders, Spring,
    StickSlip,
};

use crate::error::SimulationError;
use crate::joint_law::JointLaw;
use crate::joint_law::with_law;

/// Number of displacements between two calls of `progress`: some milliseconds of work.
const CHUNK: usize = 1 << 16;

/// Hysteretic force of a joint at the displacements `u` through which it is driven from its virgin state,
/// monotonically from one to the next.
///
/// ```
/// use iwan_core::{Jenkins, Representation, progress::UNWATCHED};
/// use iwan_sim::{JointLaw, force_history};
/// let joint = JointLaw::Jenkins(Jenkins::new(1000.0, 5.0)?);
/// let path = [0.004, 0.02, 0.016, 0.0];
/// let force = force_history(&joint, &path, Representation::Continuum, UNWATCHED)?;
/// assert_eq!(force, [4.0, 5.0, 1.0, -5.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`Error::Entry`] with the first displacement that is not finite, [`Error::Length`] or [`Error::OutOfRange`] for
/// the sliders; [`SimulationError::Interrupted`] when `progress` returns `Break`.
pub fn force_history(
    law: &JointLaw,
    u: &[f64],
    joint: Representation,
    progress: Progress<'_>,
) -> Result<Vec<f64>, SimulationError> {
    if let Some(index) = u.iter().position(|u| !u.is_finite()) {
        let (name, value, allowed) = ("displacement", u[index], "must be a finite number");
        return Err(Error::Entry { name, index, value, allowed }.into());
    }
    match joint {
        Representation::Sliders { bins, grid } => {
            let mut table = vec![Slider::default(); Sliders::table_len(bins)];
            let sliders = with_law!(law, law => Sliders::discretise(law, grid, bins, &mut table))?;
            if law.friction_ratio() != 1.0 {
                let joint = StickSlip::new(sliders);
                let state = joint.virgin(vec![Spring::default(); sliders.len()])?;
                return drive(&joint, state, u, progress);
            }
            let state = sliders.virgin(vec![Run::default(); sliders.len()])?;
            drive(&sliders, state, u, progress)
        }
        Representation::Continuum => with_law!(law, law => continuum(law, u, progress)),
    }
}

/// Drives the continuum with memory for every reversal, so that none is forgotten.
fn continuum<B: Backbone>(law: &B, u: &[f64], progress: Progress<'_>) -> Result<Vec<f64>, SimulationError> {
    let turns = |w: &&[f64]| (w[1] - w[0]) * (w[2] - w[1]) <= 0.0;
    let reversals = u.windows(3).filter(turns).count();
    let joint = Continuum::new(law);
    let state = joint.virgin(vec![Reversal::default(); reversals + 4])?;
    drive(&joint, state, u, progress)
}

fn drive<S, J: Hysteresis<S>>(
    joint: &J,
    mut state: S,
    u: &[f64],
    progress: Progress<'_>,
) -> Result<Vec<f64>, SimulationError> {
    let mut force = Vec::with_capacity(u.len());
    for chunk in u.chunks(CHUNK) {
        force.extend(chunk.iter().map(|u| joint.advance(&mut state, *u)));
        if progress(force.len() as f64 / u.len() as f64).is_break() {
            return Err(SimulationError::Interrupted);
        }
    }
    Ok(force)
}
