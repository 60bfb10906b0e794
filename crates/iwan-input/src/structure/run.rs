//! A structure file under a force in time: where the force acts, what is recorded, and the run itself.

use iwan_core::Pulse;
use iwan_fem::{
    Assembled, Error, Extras, ModalVelocity, Model, NamedMode, NamedModes, Representation, Run, Transient,
    Watch,
};

use super::file::StructureFile;
use crate::error::InputError;

/// What is to be computed of a structure in time.
#[derive(Debug, Clone)]
pub struct StructureTask<'a> {
    /// History of the force that is distributed over the loads of the file; none: no force acts.
    pub force: Option<Pulse<'a>>,
    /// Velocities of modes at t = 0; empty: the structure is at rest.
    pub velocity: &'a [ModalVelocity],
    /// Time step, s.
    pub dt: f64,
    /// Duration, s.
    pub duration: f64,
    /// How the joint laws are evaluated.
    pub representation: Representation,
    /// Which model is integrated.
    pub model: Model,
    /// Names of the modes whose coordinates are recorded; empty: the first bending modes.
    pub modes: &'a [String],
    /// Error estimates and pictures that are wanted besides the response.
    pub extras: Extras,
}

/// Why there is no response.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RunError {
    /// The structure file does not fit the task.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The analysis refused the task, failed, or was stopped.
    #[error(transparent)]
    Analysis(#[from] Error),
}

impl StructureFile {
    /// Integrates the structure, whose modes are `named`. `watch` is told the share of the response that is done, then those of the
    /// companion runs; its checkpoint, if it has one, keeps all of these runs.
    ///
    /// # Errors
    /// [`RunError`], with the fault of the structure or of the task.
    ///
    /// ```
    /// use iwan_core::Pulse;
    /// use iwan_fem::{Extras, Model, NamedModes, Representation};
    /// use iwan_input::{StructureFile, StructureTask, built_in_structure};
    /// let file = StructureFile::read(&built_in_structure("paper-a")?)?;
    /// let named = NamedModes::new(&file.structure, 3)?;
    /// let task = StructureTask {
    ///     force: Some(Pulse::Haversine { amplitude: 10.0, duration: 1.6e-3 }), // lbf, s
    ///     velocity: &[],
    ///     dt: 1e-5,
    ///     duration: 0.01,
    ///     representation: Representation::DEFAULT_IN_A_STRUCTURE,
    ///     model: Model::Basis(50),
    ///     modes: &["bending 1".to_owned()],
    ///     extras: Extras { errors: true, frames: 0 },
    /// };
    /// let run = file.run(&named, &task, iwan_core::progress::UNWATCHED)?;
    /// let peak = run.response.outputs[0].acceleration.iter().fold(0.0_f64, |most, a| most.max(a.abs()));
    /// assert!((peak / 220.78 - 1.0).abs() < 2e-3);
    /// assert!(run.errors.is_some_and(|errors| errors.time_step[0] < 0.01));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn run<'w>(
        &self,
        named: &NamedModes,
        task: &StructureTask<'_>,
        watch: impl Into<Watch<'w>>,
    ) -> Result<Run, RunError> {
        let modes = named.chosen(task.modes)?;
        let load = match task.force {
            Some(_) => self.forces(&named.assembled)?,
            None => vec![0.0; named.assembled.unknowns()],
        };
        let transient = Transient {
            dt: task.dt,
            steps: Transient::steps_in(task.dt, task.duration),
            pulse: task.force.unwrap_or(Pulse::None),
            load,
            initial_velocity: named.velocity(task.velocity)?,
            representation: task.representation,
            outputs: self.recorded(named, &modes)?,
        };
        Ok(named.run(modes, task.model, &transient, task.extras, watch)?)
    }

    /// Forces on the unknowns, one for each, of all loads together under a force of 1.
    ///
    /// # Errors
    /// [`InputError`] where the file has no load, and for a load that cannot act on the structure.
    pub fn forces(&self, assembled: &Assembled) -> Result<Vec<f64>, InputError> {
        if self.loads.is_empty() {
            let message = "the structure has no [[load]]: the force acts nowhere";
            return Err(InputError::new(message, "add [[load]] with name, nodes and direction"));
        }
        let mut forces = vec![0.0; assembled.unknowns()];
        for load in &self.loads {
            let own = load.at.forces(assembled, load.factor).map_err(|e| refused(&e))?;
            forces.iter_mut().zip(own).for_each(|(sum, f)| *sum += f);
        }
        Ok(forces)
    }

    /// The quantities to be recorded: the coordinates of these modes, then the outputs of the file.
    ///
    /// # Errors
    /// [`InputError`] for an output that has the name of a mode, and for one that the structure cannot give.
    pub fn recorded(
        &self,
        named: &NamedModes,
        modes: &[NamedMode],
    ) -> Result<Vec<iwan_fem::Output>, InputError> {
        let assembled = &named.assembled;
        let modal = |mode: &NamedMode| assembled.modal_output(&mode.name, &named.stuck, mode.pair.stuck);
        let mut recorded: Vec<iwan_fem::Output> = modes.iter().map(modal).collect();
        for output in &self.outputs {
            if modes.iter().any(|mode| mode.name == output.name) {
                let message = format!("output \"{}\" has the name of a mode", output.name);
                let remedy = "rename the output: histories are called after modes and outputs";
                return Err(InputError::new(message, remedy));
            }
            let coefficients = output.at.forces(assembled, 1.0).map_err(|e| refused(&e))?;
            recorded.push(iwan_fem::Output { name: output.name.clone(), coefficients });
        }
        Ok(recorded)
    }
}

fn refused(error: &Error) -> InputError {
    InputError::new(error.to_string(), "change this in the structure").of(error.kind())
}
