//! A run as users request it: the response of a model with its errors, the joints' force on each mode, and pictures of the motion. Both the
//! command line and the Python package use this module.

use super::model::{BasisError, Integrated, Model, StepErrors};
use super::reduction::Reduced;
use super::response::StructureResponse;
use super::task::{Output, Transient};
use super::watch::Watch;
use crate::error::Error;
use crate::modes::{NamedMode, NamedModes};

/// Results of a run besides the response. All need the reduced model; the full model gives none of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Extras {
    /// Whether to estimate the errors of time step and sliders, which takes one or two companion runs.
    pub errors: bool,
    /// Number of pictures of the moving structure; any number takes one more run.
    pub frames: usize,
}

/// A mode that has a velocity at t = 0.
#[derive(Debug, Clone, PartialEq)]
pub struct ModalVelocity {
    /// Name of the mode, in the form that [`NamedModes::named`] takes.
    pub mode: String,
    /// Velocity of the modal coordinate, mass^½·length/s.
    pub velocity: f64,
}

/// Displacements of all nodes at one time.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// Time, s.
    pub time: f64,
    /// Displacements x, y, z of the first node, then of the second, and so on.
    pub displacement: Vec<f64>,
}

/// A response with all results that belong to it.
#[derive(Debug, Clone)]
pub struct Run {
    /// The recorded modes; their histories come first in the response's outputs.
    pub modes: Vec<NamedMode>,
    /// The response.
    pub response: StructureResponse,
    /// Modal joint forces, one history per recorded mode.
    pub joint_forces: Vec<Vec<f64>>,
    /// Number of modes in the basis of the reduced model; none for the full model.
    pub basis: Option<usize>,
    /// Estimated error of the reduction, if the basis was sought by a tolerance.
    pub basis_error: Option<BasisError>,
    /// Estimated errors of time step and sliders, if requested.
    pub errors: Option<StepErrors>,
    /// Pictures of the motion at evenly spaced times, if requested.
    pub frames: Vec<Frame>,
}

impl NamedModes {
    /// Velocities of the unknowns at which the given modes move as stated; none if no mode is given and the structure starts at rest.
    ///
    /// # Errors
    /// The errors of [`named`](Self::named).
    pub fn velocity(&self, moving: &[ModalVelocity]) -> Result<Option<Vec<f64>>, Error> {
        let mut sum = vec![0.0; self.assembled.unknowns()];
        for ModalVelocity { mode, velocity } in moving {
            let shape = self.stuck.shape(self.named(mode)?.pair.stuck);
            sum.iter_mut().zip(shape).for_each(|(v, phi)| *v += velocity * phi);
        }
        Ok((!moving.is_empty()).then_some(sum))
    }

    /// Runs a transient whose first outputs are the coordinates of `modes` ([`modal_output`](crate::Assembled::modal_output)). The listener
    /// of `watch` is called with the share done of the response, then with those of the companion runs; a checkpoint holds all of them.
    ///
    /// # Errors
    /// The errors of [`Assembled::integrate`](crate::Assembled::integrate).
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
    /// Displacements of all nodes at `count` evenly spaced times; the first and the last sample are among them.
    ///
    /// # Errors
    /// The errors of [`transient`](Self::transient).
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
