//! Reduced transients whose basis grows until it no longer matters.

use std::ops::ControlFlow;

use crate::assembly::Assembled;
use crate::error::{Error, check};
use crate::reduction::Basis;
use crate::transient::{History, Progress, Transient, TruthResponse};

/// A reduced response with an estimate of what the reduction costs.
#[derive(Debug, Clone, PartialEq)]
pub struct Converged {
    /// The response of the largest basis.
    pub response: TruthResponse,
    /// Modes in that basis.
    pub modes: usize,
    /// Estimated error: twice the largest difference, over the outputs, between this response and that of half as many
    /// modes (root mean square of the accelerations' difference over that of the accelerations).
    pub error: f64,
    /// Whether `error` reached the tolerance.
    pub converged: bool,
}

/// Modes in the smallest basis tried.
const FIRST: usize = 25;
/// Modes in the largest.
const LAST: usize = 200;

impl Assembled {
    /// Integrates reduced models with 25, 50, 100, … modes until the estimated error of the outputs' accelerations is below
    /// `tolerance` (relative root mean square), with at most 200 modes.
    ///
    /// # Errors
    /// As [`Reduced::transient`](crate::Reduced::transient); [`Error::Analysis`] without outputs, as they are what is compared.
    pub fn reduced_transient(&self, of: &Transient<'_>, tolerance: f64) -> Result<Converged, Error> {
        self.reduced_transient_observed(of, tolerance, &mut |_| ControlFlow::Continue(()))
    }

    /// [`reduced_transient`](Self::reduced_transient) with a progress report that may break it off; each basis begins anew.
    ///
    /// # Errors
    /// As [`reduced_transient`](Self::reduced_transient), and [`Error::Interrupted`].
    pub fn reduced_transient_observed(
        &self,
        of: &Transient<'_>,
        tolerance: f64,
        progress: Progress<'_>,
    ) -> Result<Converged, Error> {
        check("tolerance", tolerance, tolerance > 0.0, "must be a finite number > 0")?;
        if of.outputs.is_empty() {
            let (finding, remedy) =
                ("there are no outputs to compare".to_owned(), "ask for at least one output");
            return Err(Error::Analysis { analysis: "reduced transient", finding, remedy });
        }
        let most = LAST.min(self.unknowns());
        let mut modes = FIRST.min(most);
        let mut response = self.reduce(modes, Basis::default())?.transient_observed(of, progress)?;
        loop {
            let next = (2 * modes).min(most);
            let larger = self.reduce(next, Basis::default())?.transient_observed(of, progress)?;
            let pairs = larger.outputs.iter().zip(&response.outputs);
            let error = pairs.map(|(fine, coarse)| 2.0 * distance(coarse, fine)).fold(0.0, f64::max);
            (response, modes) = (larger, next);
            if error <= tolerance || modes == most {
                return Ok(Converged { response, modes, error, converged: error <= tolerance });
            }
        }
    }
}

/// Root mean square of the difference of accelerations over that of the reference; 0 for two that do not move.
fn distance(of: &History, reference: &History) -> f64 {
    let pairs = of.acceleration.iter().zip(&reference.acceleration);
    let difference: f64 = pairs.map(|(a, b)| (a - b).powi(2)).sum();
    let size: f64 = reference.acceleration.iter().map(|a| a * a).sum();
    if size > 0.0 { (difference / size).sqrt() } else { 0.0 }
}
