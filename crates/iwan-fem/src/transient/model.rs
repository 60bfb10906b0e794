//! The choice of the model that is integrated, and error estimates of the response from companion runs.

use super::reduction::{Basis, Reduced};
use super::response::{History, StructureResponse};
use super::task::Transient;
use super::watch::Watch;
use crate::error::Error;
use crate::matrices::Assembled;
use iwan_core::Representation;
use iwan_core::progress::part;

/// The model of a structure that is integrated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Model {
    /// All unknowns.
    Full,
    /// A reduced model with this many stuck modes and the attachment vectors of the slips.
    Basis(usize),
    /// A reduced model with as many modes as the outputs' accelerations need for this relative error.
    Tolerance(f64),
    /// The basis that the [structure holds](crate::Structure::kept).
    Kept,
}

impl Model {
    /// A reduced model accurate enough for most studies: accelerations within 5 %, displacements far better. The error is an estimate from
    /// the last doubling of the basis; under 1000 lbf on the paper's beam 50 modes reach it, with a true error below 1e-3.
    pub const USUAL: Self = Self::Tolerance(0.05);
}

/// The response of a model, with the reduced model.
#[derive(Debug, Clone)]
pub struct Integrated<'a> {
    /// The response.
    pub response: StructureResponse,
    /// The reduced model; none for the full one.
    pub reduced: Option<Reduced<'a>>,
    /// Estimated error of the reduction, if the basis was sought by a tolerance.
    pub basis_error: Option<BasisError>,
}

/// Error from the modes that the basis leaves out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BasisError {
    /// Estimated relative error of the outputs' accelerations, as in [`Converged::error`](crate::Converged::error).
    pub estimate: f64,
    /// Whether the estimate reached the tolerance that was asked for.
    pub converged: bool,
}

/// Estimated errors of a response, one per output, relative to the output's peak displacement.
#[derive(Debug, Clone, PartialEq)]
pub struct StepErrors {
    /// Error of the time step, from a run with twice the step; the scheme is of second order.
    pub time_step: Vec<f64>,
    /// Error of the joints' sliders, against the continuum; none if the continuum was integrated.
    pub sliders: Option<Vec<f64>>,
}

impl Assembled {
    /// Integrates a model of the structure. The listener of `watch` is called with the share done, which rises to 1; a search for the basis
    /// may end before 1.
    ///
    /// # Errors
    /// The errors of [`transient_observed`](Self::transient_observed) and [`reduced_transient`](Self::reduced_transient).
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
    /// Number of modes in the basis: the one that `model` states, otherwise that of the basis which the structure holds.
    ///
    /// # Errors
    /// [`Error::Modes`] for no modes, or more than there are unknowns; [`Error::Analysis`] if the structure holds no basis.
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
    /// Number of modes in the basis of the reduced model; none for the full model.
    #[must_use]
    pub fn basis(&self) -> Option<usize> {
        self.reduced.as_ref().map(|reduced| reduced.modes().len())
    }
}

impl Reduced<'_> {
    /// Errors of a response of this model, estimated by companion runs.
    ///
    /// # Errors
    /// The errors of [`transient_observed`](Self::transient_observed).
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

/// Largest difference of displacements at the samples that two histories share, over the peak of `history`.
fn difference(history: &History, other: &History, stride: usize) -> f64 {
    let peak = history.displacement.iter().fold(0.0, |most: f64, u| most.max(u.abs()));
    let pairs = history.displacement.iter().step_by(stride).zip(&other.displacement);
    let largest = pairs.fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
    if peak > 0.0 { largest / peak } else { 0.0 }
}
