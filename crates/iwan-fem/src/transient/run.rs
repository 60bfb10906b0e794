//! A run as users ask for it: the response of a model with its errors, the joints' force on each mode, and pictures of the
//! motion. The command line and the Python package both go this way.

use super::model::{BasisError, Integrated, Model, StepErrors};
use super::reduction::Reduced;
use super::response::StructureResponse;
use super::task::{Output, Transient};
use super::watch::Watch;
use crate::error::Error;
use crate::modes::{NamedMode, NamedModes};

/// What a run gives besides the response; all of it from the reduced model, so that the full one gives none.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Extras {
    /// Whether to estimate the errors of time step and sliders, by one or two companion runs.
    pub errors: bool,
    /// Number of pictures of the moving structure, by one more run.
    pub frames: usize,
}

/// A mode that moves at t = 0.
#[derive(Debug, Clone, PartialEq)]
pub struct ModalVelocity {
    /// Name of the mode, as [`NamedModes::named`] takes it.
    pub mode: String,
    /// Velocity of its coordinate, mass^½·length/s.
    pub velocity: f64,
}

/// Displacements of all nodes at one time.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// Time, s.
    pub time: f64,
    /// x, y, z of the first node, then of the second, …
    pub displacement: Vec<f64>,
}

/// A response with all that belongs to it.
#[derive(Debug, Clone)]
pub struct Run {
    /// The modes that were recorded; their histories come first in the response.
    pub modes: Vec<NamedMode>,
    /// The response.
    pub response: StructureResponse,
    /// Modal joint forces, one history per recorded mode.
    pub joint_forces: Vec<Vec<f64>>,
    /// Modes in the basis of the reduced model; none for the full one.
    pub basis: Option<usize>,
    /// Estimated error of the reduction, where it was sought.
    pub basis_error: Option<BasisError>,
    /// Estimated errors of time step and sliders, where asked for.
    pub errors: Option<StepErrors>,
    /// Pictures of the motion at evenly spaced times, where asked for.
    pub frames: Vec<Frame>,
}

impl NamedModes {
    /// Velocities of the unknowns in which these modes move as said; none without any: the structure is at rest.
    ///
    /// # Errors
    /// As [`named`](Self::named).
    pub fn velocity(&self, moving: &[ModalVelocity]) -> Result<Option<Vec<f64>>, Error> {
        let mut sum = vec![0.0; self.assembled.unknowns()];
        for ModalVelocity { mode, velocity } in moving {
            let shape = self.stuck.shape(self.named(mode)?.pair.stuck);
            sum.iter_mut().zip(shape).for_each(|(v, phi)| *v += velocity * phi);
        }
        Ok((!moving.is_empty()).then_some(sum))
    }

    /// Runs a transient whose first outputs are the coordinates of `modes`
    /// ([`modal_output`](crate::Assembled::modal_output)). `watch` hears the share done of the response, then those of its
    /// companions; a checkpoint of it keeps them all.
    ///
    /// # Errors
    /// As [`Assembled::integrate`](crate::Assembled::integrate).
    pub fn run<'w>(
        &self,
        modes: Vec<NamedMode>,
        model: Model,
        task: &Transient<'_>,
        extras: Extras,
        watch: impl Into<Watch<'w>>,
    ) -> Result<Run, Error> {
        let watch = watch.into();
        let integrated = self.assembled.integrate(model, task, watch)?;
        let basis = integrated.basis();
        let Integrated { response, reduced, basis_error } = integrated;
        let (mut errors, mut frames) = (None, Vec::new());
        if let Some(reduced) = &reduced {
            if extras.errors {
                errors = Some(reduced.step_errors(task, &response, watch)?);
            }
            if extras.frames > 0 {
                frames = reduced.frames(task, extras.frames, watch)?;
            }
        }
        let joint_force = |(mode, history): (&NamedMode, _)| {
            let stuck = (&self.stuck, mode.pair.stuck);
            self.assembled.modal_joint_force(&response, history, stuck, mode.pair.k_t)
        };
        let joint_forces = modes.iter().zip(&response.outputs).map(joint_force).collect();
        Ok(Run { modes, response, joint_forces, basis, basis_error, errors, frames })
    }
}

impl Reduced<'_> {
    /// Displacements of all nodes at `count` evenly spaced times, the first and the last sample among them.
    ///
    /// # Errors
    /// As [`transient`](Self::transient).
    pub fn frames<'w>(
        &self,
        task: &Transient<'_>,
        count: usize,
        watch: impl Into<Watch<'w>>,
    ) -> Result<Vec<Frame>, Error> {
        let assembled = self.assembled();
        let coordinate =
            |k: usize| Output { name: k.to_string(), coefficients: assembled.mass().times(self.column(k)) };
        let outputs = (0..self.coordinates()).map(coordinate).collect();
        let response = self.transient_observed(&Transient { outputs, ..task.clone() }, watch)?;
        let frame = |n: usize| {
            let sample = if count > 1 { n * task.steps / (count - 1) } else { 0 };
            let mut unknowns = vec![0.0; assembled.unknowns()];
            for (k, history) in response.outputs.iter().enumerate() {
                let q = history.displacement[sample];
                unknowns.iter_mut().zip(self.column(k)).for_each(|(x, v)| *x += q * v);
            }
            Frame { time: sample as f64 * task.dt, displacement: assembled.displacements(&unknowns) }
        };
        Ok((0..count).map(frame).collect())
    }
}
