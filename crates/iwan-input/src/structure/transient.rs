//! What a structure file says about a transient: where the force acts, and what is recorded.

use iwan_fem::{Assembled, Error, NamedMode, NamedModes};

use super::StructureFile;
use crate::error::InputError;

impl StructureFile {
    /// Forces on the unknowns under a force of 1: all loads together.
    ///
    /// # Errors
    /// [`InputError`] without any load, and for one that cannot act.
    pub fn forces(&self, assembled: &Assembled) -> Result<Vec<f64>, InputError> {
        if self.loads.is_empty() {
            let message = "the structure has no [[load]]: the force acts nowhere";
            return Err(InputError::new(message, "add [[load]] with name, nodes and direction"));
        }
        let mut forces = vec![0.0; assembled.unknowns()];
        for load in &self.loads {
            let force = load.direction.map(|d| d * load.factor);
            let own = assembled.load(&load.nodes, force).map_err(|e| refused(&e))?;
            forces.iter_mut().zip(own).for_each(|(sum, f)| *sum += f);
        }
        Ok(forces)
    }

    /// What is recorded: the coordinates of these modes, then the outputs of the file.
    ///
    /// # Errors
    /// [`InputError`] for an output with the name of a mode, and for one that cannot be read.
    pub fn recorded(
        &self,
        of: &NamedModes,
        modes: &[NamedMode],
    ) -> Result<Vec<iwan_fem::Output>, InputError> {
        let assembled = &of.assembled;
        let modal = |mode: &NamedMode| assembled.modal_output(&mode.name, &of.stuck, mode.pair.stuck);
        let mut recorded: Vec<iwan_fem::Output> = modes.iter().map(modal).collect();
        for output in &self.outputs {
            if modes.iter().any(|mode| mode.name == output.name) {
                let message = format!("output \"{}\" has the name of a mode", output.name);
                let remedy = "rename the output: histories are called after modes and outputs";
                return Err(InputError::new(message, remedy));
            }
            let own = assembled.output(&output.name, &output.nodes, output.direction);
            recorded.push(own.map_err(|e| refused(&e))?);
        }
        Ok(recorded)
    }
}

fn refused(error: &Error) -> InputError {
    InputError::new(error.to_string(), "change this in the structure")
}
