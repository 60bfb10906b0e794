//! A structure with its linear modes, named: what the structure commands begin with.

use std::ops::Deref;
use std::sync::Arc;

use iwan_fem::NamedModes;
use iwan_input::{BUILT_IN_STRUCTURES, InputError, InputText, ReducedFolder, StructureFile};

use super::args::StructureArgs;
use crate::failure::Failure;
use crate::progress::Bar;

/// Elastic modes among which a name is looked up: twice as many as `iwan modes` lists unless told, so that whatever stands in
/// its table is found. A name beyond them is refused as unknown.
pub(crate) const NAMED_MODES: usize = 40;

/// A structure file and the modes of its structure; a clone shares both, for work beside the thread that watches for Ctrl-C.
#[derive(Debug, Clone)]
pub(crate) struct Linear {
    /// Name for messages.
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
        Error::Memory(short) => Failure::lacking(&format!("{source}: {short}")),
        Error::Analysis { .. } => Failure::computation(format!("{source}: {error}")).of(error.kind()),
        Error::MissingMode { .. } => Failure::said(source, error),
        error => {
            Failure::input(format!("{source}: {error}"), "change this in the structure").of(error.kind())
        }
    }
}

/// Above so many unknowns memory is spoken of: below, a factor takes some hundred megabytes at most.
const LARGE: usize = 50_000;

/// What modes of a large structure need.
fn memory_of(unknowns: usize, [all, factor]: [u64; 2], count: usize) -> String {
    let gigabytes = |bytes: u64| format!("{:.1} GB", bytes as f64 / 1e9);
    format!(
        "note: {unknowns} unknowns: a search for {count} modes takes about {} of memory, two factors of {} each among it",
        gigabytes(all),
        gigabytes(factor)
    )
}

impl Linear {
    /// Computes at least `count` elastic modes in both limits. That is done beside this thread, which watches for Ctrl-C also while a matrix
    /// is factored; how much memory that takes is said before where it is much.
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

    /// What in the file does not fit the run.
    pub(crate) fn refused(&self, InputError { message, remedy, kind }: InputError) -> Failure {
        Failure::input(format!("{}: {message}", self.source), remedy).of(kind)
    }
}
