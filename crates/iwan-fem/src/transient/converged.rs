//! Reduced transients whose basis grows until more modes no longer change the result.

use super::reduction::{Basis, Reduced};
use super::response::{History, StructureResponse};
use super::task::Transient;
use super::watch::Watch;
use crate::error::{Error, check};
use crate::matrices::Assembled;
use iwan_core::progress::UNWATCHED;
use iwan_core::progress::part;

/// A reduced response with an estimate of the error of the reduction.
#[derive(Debug, Clone)]
pub struct Converged<'a> {
    /// The reduced model with the largest basis.
    pub reduced: Reduced<'a>,
    /// The response of that model.
    pub response: StructureResponse,
    /// Estimated error: twice the largest difference, over the outputs, between this response and that of half as many
    /// modes (root mean square of the accelerations' difference over that of the accelerations).
    pub error: f64,
    /// Whether `error` reached the tolerance.
    pub converged: bool,
}

/// Number of modes in the smallest basis. The second basis, of 50 modes, is accurate to 5e-4 under 1000 lbf on the paper's beam, so the
/// search mostly ends with it.
const FIRST: usize = 25;
/// Number of modes in the largest basis: under 1000 lbf 400 modes agree with 800 to 2e-6 and take a third of the time. If they do not reach
/// the tolerance, [`Converged::converged`] is false.
const LAST: usize = 400;

impl Assembled {
    /// Integrates reduced models with 25, 50, 100, … modes until the estimated error of the outputs' accelerations is below
    /// `tolerance` (relative root mean square), with at most 400 modes.
    ///
    /// # Errors
    /// The errors of [`Reduced::transient`](crate::Reduced::transient); [`Error::Analysis`] without outputs, because these are compared.
    pub fn reduced_transient(&self, task: &Transient<'_>, tolerance: f64) -> Result<Converged<'_>, Error> {
        self.reduced_transient_observed(task, tolerance, UNWATCHED)
    }

    /// [`reduced_transient`](Self::reduced_transient) with a progress report whose listener may stop it, and with a checkpoint. Each basis
    /// takes half of the share of progress that is left.
    ///
    /// # Errors
    /// The errors of [`reduced_transient`](Self::reduced_transient), and [`Error::Interrupted`].
    pub fn reduced_transient_observed<'w>(
        &self,
        task: &Transient<'_>,
        tolerance: f64,
        watch: impl Into<Watch<'w>>,
    ) -> Result<Converged<'_>, Error> {
        let watch = watch.into();
        check("tolerance", tolerance, tolerance > 0.0, "must be a finite number > 0")?;
        if task.outputs.is_empty() {
            let (finding, remedy) =
                ("there are no outputs to compare".to_owned(), "ask for at least one output");
            return Err(Error::Analysis { analysis: "reduced transient", finding, remedy });
        }
        let most = LAST.min(self.unknowns());
        let mut modes = FIRST.min(most);
        let respond = |modes: usize, done: f64| -> Result<_, Error> {
            let ends = [0.5, 1.0].map(|half: f64| done + 0.5 * half * (1.0 - done));
            let reducing = part(watch.progress, [done, ends[0]]);
            let reduced = self.reduce_observed(modes, Basis::default(), &reducing)?;
            let response = reduced.transient_observed(task, watch.with(&part(watch.progress, ends)))?;
            Ok((reduced, response, ends[1]))
        };
        let (_, mut response, mut done) = respond(modes, 0.0)?;
        loop {
            let next = (2 * modes).min(most);
            let (reduced, larger, end) = respond(next, done)?;
            let pairs = larger.outputs.iter().zip(&response.outputs);
            let error = pairs.map(|(fine, coarse)| 2.0 * distance(coarse, fine)).fold(0.0, f64::max);
            (response, modes, done) = (larger, next, end);
            if error <= tolerance || modes == most {
                return Ok(Converged { reduced, response, error, converged: error <= tolerance });
            }
        }
    }
}

/// Root mean square of the difference of two accelerations, over that of the reference; 0 if the reference does not move.
fn distance(history: &History, reference: &History) -> f64 {
    let pairs = history.acceleration.iter().zip(&reference.acceleration);
    let difference: f64 = pairs.map(|(a, b)| (a - b).powi(2)).sum();
    let size: f64 = reference.acceleration.iter().map(|a| a * a).sum();
    if size > 0.0 { (difference / size).sqrt() } else { 0.0 }
}
