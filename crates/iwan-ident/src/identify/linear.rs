//! The simplest law: a linear mode without a joint.

use std::f64::consts::TAU;

use super::identification::Linear;
use crate::curves::Curves;
use crate::error::Error;
use crate::parameters::Parameters;
use crate::refine::Task;
use crate::search::Minimum;

/// Part of ω0² that stands for no joint at all: the frequency then shifts by 5e-10 at most, far below what any record tells. The value is not zero
/// because the joint's law needs K_T > 0.
const NO_JOINT: f64 = 1e-9;

/// The linear mode fitted to the same records, beginning with the mean damping of the curves.
pub(super) fn linear(
    task: &Task,
    minimum: &Minimum,
    parameters: &Parameters,
    curves: &[Curves],
) -> Result<Linear, Error> {
    let ratios: Vec<f64> = curves.iter().flat_map(|c| c.damping_ratio.iter().copied()).collect();
    let damping_ratio = (ratios.iter().sum::<f64>() / ratios.len() as f64).max(0.0);
    let omega_squared = (TAU * parameters.frequency).powi(2);
    let first = Parameters {
        damping_ratio,
        k_t: NO_JOINT * omega_squared,
        f_s: omega_squared,
        chi: 0.0,
        beta: 0.0,
        ..*parameters
    };
    let (linear, found) = task.without_joint(&first, minimum)?;
    let (n, fewer) = (task.count() as f64, (task.free().len() - linear.free().len()) as f64);
    let refined = linear.refined(&found);
    Ok(Linear {
        frequency: refined.parameters.frequency,
        damping_ratio: refined.parameters.damping_ratio,
        relative_residual: refined.relative_residual,
        criterion: n * (found.cost / minimum.cost).ln() - fewer * n.ln(),
    })
}
