//! A structure with its linear modes, named: what the structure commands begin with.

use std::ops::Deref;

use iwan_fem::NamedModes;
use iwan_input::{BUILT_IN_STRUCTURES, InputError, InputText, ReducedFolder, StructureFile};

use super::args::StructureArgs;
use crate::failure::Failure;

/// Elastic modes among which a name is looked up: twice as many as `iwan modes` lists unless told, so that whatever stands in
/// its table is found. A name beyond them is refused as unknown.
pub(crate) const NAMED_MODES: usize = 40;

/// A structure file and the modes of its structure.
#[derive(Debug)]
pub(crate) struct Linear {
    /// Name for messages.
    pub(crate) source: String,
    /// The file.
    pub(crate) file: StructureFile,
    modes: NamedModes,
}

impl Deref for Linear {
    type Target = NamedModes;

    fn deref(&self) -> &NamedModes {
        &self.modes
    }
}

/// The structure file that was given, the folder of a reduced model, or the built-in structure.
pub(crate) fn load(args: &StructureArgs) -> Result<(InputText, StructureFile), Failure> {
    let source = match &args.path {
        Some(path) if ReducedFolder::is_one(path) => return Ok(StructureFile::open_reduced(path)?),
        Some(path) => InputText::read(path, "structure", BUILT_IN_STRUCTURES[0].0)?,
        None => InputText::built_in(BUILT_IN_STRUCTURES[0].0, BUILT_IN_STRUCTURES[0].2),
    };
    let file = StructureFile::read(&source)?;
    Ok((source, file))
}

/// A failure of the analysis in the user's terms: what could not be set up is bad input, the rest failed.
pub(crate) fn explain(source: &str, error: &iwan_fem::Error) -> Failure {
    use iwan_fem::Error;
    match error {
        Error::Interrupted => Failure::Interrupted,
        Error::Analysis { .. } => Failure::Computation(format!("{source}: {error}")),
        Error::MissingMode { .. } => Failure::said(source, error),
        error => Failure::input(format!("{source}: {error}"), "change this in the structure"),
    }
}

impl Linear {
    /// Computes at least `count` elastic modes in both limits, with a progress report that may break it off.
    pub(crate) fn observed(
        source: String,
        file: StructureFile,
        count: usize,
        progress: iwan_core::Progress<'_>,
    ) -> Result<Self, Failure> {
        let modes = NamedModes::observed(&file.structure, count, progress);
        let modes = modes.map_err(|error| explain(&source, &error))?;
        Ok(Self { source, file, modes })
    }

    /// A failure of the analysis of this structure.
    pub(crate) fn failed(&self, error: &iwan_fem::Error) -> Failure {
        explain(&self.source, error)
    }

    /// What in the file does not fit the run.
    pub(crate) fn refused(&self, InputError { message, remedy }: InputError) -> Failure {
        Failure::input(format!("{}: {message}", self.source), remedy)
    }
}
