//! Simulation in the loop: the parameters whose ring-down is the record itself.
//!
//! The forward model is the half-cycle map of iwan-core. Record and model are compared by complex amplitudes in windows (the room `amplitudes`),
//! taken of both alike. Each record brings unknowns of its own: amplitude and time of the turning point next to its first sample, and its frequency
//! where records may differ by the day. The joint is taken to have been loaded along its virgin curve up to that turning point. This is exact for a
//! release from rest; later in a decay, where loops shrink slowly, the tips of the loops lie next to the virgin curve.
//!
//! First the logarithms of the amplitudes, with unwrapped phases, are matched from several starts, so that no cycle is lost on the way; then the
//! amplitudes themselves, weighted by each record's noise.

mod release;
mod ring_down;
mod amplitudes;
mod record;
mod discount;
mod task;
mod residuals;
mod fields;
mod nested;
mod sizes;
mod knees;
mod valleys;
mod discrepancy;

use crate::error::Error;
use crate::parameters::{Parameter, Parameters};
pub(crate) use amplitudes::days::may_stray;
pub(crate) use amplitudes::whitening::Whitening;
pub(crate) use amplitudes::windows::OVERLAP;
pub(crate) use discrepancy::Clean;
pub(crate) use record::check_rate;
pub(crate) use release::Sampling;
pub use release::TurningPoint;
pub use ring_down::{Discrepancy, Refined, RingDown};
pub(crate) use task::{Effort, Task, Workspace};
pub(crate) use valleys::Solved;

/// Refines parameters on the records themselves, several force levels at once, beginning with `first`; parameters in `held` keep their values there.
///
/// # Errors
/// [`Error::OutOfRange`], [`Error::NotFinite`], [`Error::TooShort`]; [`Error::Model`] when `first` is no model;
/// [`Error::Refused`] when no search succeeds.
///
/// ```
/// use iwan_core::{Decay, Reversal, Samples};
/// use iwan_ident::{Parameters, curves::Quantity, refine::{RingDown, refine}};
/// let truth = Parameters { frequency: 124.0, damping_ratio: 1e-3, k_t: 4.45e4, f_s: 239.4, chi: -0.183, beta: 0.3 };
/// let (oscillator, joint) = truth.model()?;
/// let mut out = [vec![0.0; 1000], vec![0.0; 1000], vec![0.0; 1000], vec![0.0; 1000]];
/// let [displacement, velocity, acceleration, joint_force] = &mut out;
/// let start = iwan_core::Motion::held_at(1.5 * joint.phi_max());
/// Decay::new(&oscillator, &joint, 0.0, start, vec![Reversal::default(); 99])?
///     .sample(2e-4, &mut Samples { displacement, velocity, acceleration, joint_force })?;
/// let record = RingDown { samples: &out[2], dt: 2e-4, quantity: Quantity::Acceleration, band: None, beside: None };
/// let first = Parameters { k_t: 5e4, f_s: 220.0, chi: -0.3, beta: 0.5, ..truth };
/// let refined = refine(&[record], &first, &[])?;
/// assert!((refined.parameters.f_s / truth.f_s - 1.0).abs() < 1e-3);
/// # Ok::<(), iwan_ident::Error>(())
/// ```
pub fn refine(records: &[RingDown<'_>], first: &Parameters, held: &[Parameter]) -> Result<Refined, Error> {
    first.model()?;
    let mut task = Task::new(records, first, held)?;
    let Solved { best, .. } = task.solve(first)?;
    let minimum = task.finish(&best)?;
    let minimum = task.deepest_of_all(minimum)?;
    let start = task.coordinates(first)?;
    let minimum = task.discounted(minimum, &[&start])?;
    Ok(task.refined(&minimum))
}
