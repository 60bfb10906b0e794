//! A structure with its named linear modes, with which the commands on structures begin.

use std::ops::Deref;
use std::sync::Arc;

use iwan_fem::NamedModes;
use iwan_input::{BUILT_IN_STRUCTURES, InputError, InputText, ReducedFolder, StructureFile};

use super::args::StructureArgs;
use crate::failure::Failure;
use crate::progress::Bar;

/// Number of elastic modes among which a mode is looked up by name: twice as many as `iwan modes` lists by default, so that every name in its table
/// is found. A name beyond them is refused as unknown.
pub(crate) const NAMED_MODES: usize = 40;

/// A structure file and the modes of its structure. A clone shares both, for work beside the thread that watches for Ctrl-C.
#[derive(Debug, Clone)]
pub(crate) struct Linear {
    /// Name of the structure in messages.
    pub(crate) source: String,
    /// The file.
    pub(crate) file: Arc<StructureFile>,
    modes: Arc<NamedModes>,
}

impl Deref for Linear {
    type Target = NamedModes;

    fn deref(&self) -> &NamedModes {
        &self.modes
    }
}

/// Opens the given structure file, the folder of a reduced model, or the built-in structure.
pub(crate) fn load(args: &StructureArgs) -> Result<(InputText, StructureFile), Failure> {
    let source = match &args.path {
        Some(path) if ReducedFolder::is_one(path) => return Ok(StructureFile::open_reduced(path)?),
        Some(path) => InputText::read(path, "structure", BUILT_IN_STRUCTURES[0].0)?,
        None => InputText::built_in(BUILT_IN_STRUCTURES[0].0, BUILT_IN_STRUCTURES[0].2),
    };
    let file = StructureFile::read(&source)?;
    Ok((source, file))
}

/// A failed analysis in the user's terms: what cannot be set up is bad input, any other error a failed computation.
pub(crate) fn explain(source: &str, error: &iwan_fem::Error) -> Failure {
    use iwan_fem::Error;
    match error {
        Error::Interrupted => Failure::Interrupted,
        Error::Memory(short) => Failure::lacking(&format!("{source}: {short}")),
        Error::Analysis { .. } => Failure::computation(format!("{source}: {error}")).of(error.kind()),
        Error::MissingMode { .. } => Failure::said(source, error),
        error => {
            Failure::input(format!("{source}: {error}"), "change this in the structure").of(error.kind())
        }
    }
}

/// Above this number of unknowns a note names the memory that the analysis takes; below, a factor takes some hundred megabytes at most.
const LARGE: usize = 50_000;

/// The note on the memory that the modes of a large structure take.
fn memory_of(unknowns: usize, [all, factor]: [u64; 2], count: usize) -> String {
    let gigabytes = |bytes: u64| format!("{:.1} GB", bytes as f64 / 1e9);
    format!(
        "note: {unknowns} unknowns: a search for {count} modes takes about {} of memory, two factors of {} each among it",
        gigabytes(all),
        gigabytes(factor)
    )
}

impl Linear {
    /// Computes at least `count` elastic modes with all joints stuck and with all slipping. The work runs beside this thread, which watches for
    /// Ctrl-C even while a matrix is factored. Where the work takes much memory, a note says so first.
    pub(crate) fn computed(
        source: String,
        file: StructureFile,
        count: usize,
        bar: &Bar,
    ) -> Result<Self, Failure> {
        let (structure, teller) = (file.structure.clone(), bar.teller());
        let modes = bar.wait(move || {
            let assembled = structure.assemble()?;
            let unknowns = assembled.unknowns();
            if unknowns > LARGE && structure.kept.is_none() {
                teller.say(&memory_of(unknowns, assembled.search_bytes(count)?, count));
            }
            NamedModes::of(assembled, count, &|share| teller.report(share))
        })?;
        let modes = modes.map_err(|error| explain(&source, &error))?;
        Ok(Self { source, file: Arc::new(file), modes: Arc::new(modes) })
    }

    /// A failure of the analysis of this structure.
    pub(crate) fn failed(&self, error: &iwan_fem::Error) -> Failure {
        explain(&self.source, error)
    }

    /// An error by a part of the file that does not fit the run, as a failure.
    pub(crate) fn refused(&self, InputError { message, remedy, kind }: InputError) -> Failure {
        Failure::input(format!("{}: {message}", self.source), remedy).of(kind)
    }
}
