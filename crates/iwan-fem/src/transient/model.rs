//! Which model of a structure is integrated, and what companion runs say about the errors of the response.

use super::reduction::{Basis, Reduced};
use super::response::{History, StructureResponse};
use super::task::Transient;
use super::watch::Watch;
use crate::error::Error;
use crate::matrices::Assembled;
use iwan_core::Representation;
use iwan_core::progress::part;

/// Which model is integrated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Model {
    /// All unknowns.
    Full,
    /// This many stuck modes and the attachment vectors of the slips.
    Basis(usize),
    /// The same with as many modes as the outputs' accelerations need for this relative error.
    Tolerance(f64),
    /// The basis that the structure [brings with it](crate::Structure::kept).
    Kept,
}

impl Model {
    /// The reduced model as good as most studies need: accelerations within 5 %, displacements far better. It is an estimate from the last
    /// doubling of the basis; under 1000 lbf on the paper's beam 50 modes reach it, with a true error below 1e-3.
    pub const USUAL: Self = Self::Tolerance(0.05);
}

/// The response of a model, and what was reduced.
#[derive(Debug, Clone)]
pub struct Integrated<'a> {
    /// The response.
    pub response: StructureResponse,
    /// The reduced model; none for the full one.
    pub reduced: Option<Reduced<'a>>,
    /// Estimated error of the reduction, where it was sought.
    pub basis_error: Option<BasisError>,
}

/// What it costs to leave modes out of the basis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BasisError {
    /// Estimated relative error of the outputs' accelerations, as in [`Converged::error`](crate::Converged::error).
    pub estimate: f64,
    /// Whether the estimate reached the tolerance that was asked for.
    pub converged: bool,
}

/// Estimated errors, one per output, relative to its peak displacement.
#[derive(Debug, Clone, PartialEq)]
pub struct StepErrors {
    /// Of the time step: against twice the step, as the scheme is of second order.
    pub time_step: Vec<f64>,
    /// Of cutting the joints into sliders: against the continuum; none when that is what was integrated.
    pub sliders: Option<Vec<f64>>,
}

impl Assembled {
    /// Integrates a model of the structure. `watch` hears a share done that rises to 1; a search for the basis may end
    /// before.
    ///
    /// # Errors
    /// As [`transient_observed`](Self::transient_observed) and [`reduced_transient`](Self::reduced_transient).
    pub fn integrate<'w>(
        &self,
        model: Model,
        task: &Transient<'_>,
        watch: impl Into<Watch<'w>>,
    ) -> Result<Integrated<'_>, Error> {
        let watch = watch.into();
        task.check(self.unknowns(), self.slips().len())?;
        match model {
            Model::Full => {
                let response = self.transient_observed(task, watch)?;
                Ok(Integrated { response, reduced: None, basis_error: None })
            }
            Model::Basis(_) | Model::Kept => {
                let modes = self.basis_of(model)?;
                let (reducing, stepping) =
                    (part(watch.progress, [0.0, 0.5]), part(watch.progress, [0.5, 1.0]));
                let reduced = self.reduce_observed(modes, Basis::default(), &reducing)?;
                let response = reduced.transient_observed(task, watch.with(&stepping))?;
                Ok(Integrated { response, reduced: Some(reduced), basis_error: None })
            }
            Model::Tolerance(tolerance) => {
                let found = self.reduced_transient_observed(task, tolerance, watch)?;
                let basis_error = BasisError { estimate: found.error, converged: found.converged };
                let (response, reduced) = (found.response, Some(found.reduced));
                Ok(Integrated { response, reduced, basis_error: Some(basis_error) })
            }
        }
    }
}

impl Assembled {
    /// Modes in the basis of a model that says how many; of others those of the basis that the structure brings with it.
    ///
    /// # Errors
    /// [`Error::Modes`] for no modes, or more than there are unknowns; [`Error::Analysis`] for a structure without a basis of its own.
    pub fn basis_of(&self, model: Model) -> Result<usize, Error> {
        match (model, self.structure().kept.as_deref()) {
            (Model::Basis(modes), _) => self.check_modes("basis", modes),
            (_, Some(kept)) => Ok(kept.basis.values.len()),
            (_, None) => Err(Error::Analysis {
                analysis: "the reduced model",
                finding: "the structure was not opened from the folder of one".into(),
                remedy: "name the folder with reduced = \"FOLDER\", or choose another model",
            }),
        }
    }

    /// A number of modes that the structure can have.
    pub(crate) fn check_modes(&self, name: &'static str, value: usize) -> Result<usize, Error> {
        let most = self.unknowns();
        if (1..=most).contains(&value) { Ok(value) } else { Err(Error::Modes { name, value, most }) }
    }
}

impl Integrated<'_> {
    /// Modes in the basis of the reduced model; none for the full one.
    #[must_use]
    pub fn basis(&self) -> Option<usize> {
        self.reduced.as_ref().map(|reduced| reduced.modes().len())
    }
}

impl Reduced<'_> {
    /// Errors of a response of this model, by companion runs.
    ///
    /// # Errors
    /// As [`transient_observed`](Self::transient_observed).
    pub fn step_errors<'w>(
        &self,
        task: &Transient<'_>,
        response: &StructureResponse,
        watch: impl Into<Watch<'w>>,
    ) -> Result<StepErrors, Error> {
        let watch = watch.into();
        let coarse = Transient { dt: 2.0 * task.dt, steps: task.steps / 2, ..task.clone() };
        let coarse = self.transient_observed(&coarse, watch)?;
        let pairs = response.outputs.iter().zip(&coarse.outputs);
        let time_step = pairs.map(|(fine, coarse)| difference(fine, coarse, 2) / 3.0).collect();
        let sliders = match task.representation {
            Representation::Continuum => None,
            Representation::Sliders { .. } => {
                let exact = Transient { representation: Representation::Continuum, ..task.clone() };
                let exact = self.transient_observed(&exact, watch)?;
                let pairs = response.outputs.iter().zip(&exact.outputs);
                Some(pairs.map(|(cut, exact)| difference(cut, exact, 1)).collect())
            }
        };
        Ok(StepErrors { time_step, sliders })
    }
}

/// Largest difference of displacements at the samples that two histories share, over the peak.
fn difference(history: &History, other: &History, stride: usize) -> f64 {
    let peak = history.displacement.iter().fold(0.0, |most: f64, u| most.max(u.abs()));
    let pairs = history.displacement.iter().step_by(stride).zip(&other.displacement);
    let largest = pairs.fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
    if peak > 0.0 { largest / peak } else { 0.0 }
}
