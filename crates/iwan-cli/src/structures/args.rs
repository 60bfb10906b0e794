//! Options of the commands that work on finite-element structures.

use std::path::PathBuf;

use clap::{Args, ValueHint};

use crate::session::Place;

/// The structure, and where results go.
#[derive(Debug, Args)]
pub(crate) struct StructureArgs {
    /// Structure file (TOML); without one the built-in `paper-a` is taken
    #[arg(value_name = "STRUCTURE.toml", value_hint = ValueHint::FilePath)]
    pub(crate) path: Option<PathBuf>,
    /// Folder for the results; without it `iwan-modes` or `iwan-quasi-static`, or the next free number behind it
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub(crate) out: Option<PathBuf>,
    /// Overwrite results that are there already
    #[arg(long)]
    pub(crate) force: bool,
}

impl StructureArgs {
    /// Where results go.
    pub(crate) fn place(&self, default: &'static str) -> Place<'_> {
        Place { given: self.out.as_deref(), default, force: self.force }
    }
}
