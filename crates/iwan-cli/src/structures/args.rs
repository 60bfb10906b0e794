//! Options of the commands that work on finite-element structures.

use std::path::{Path, PathBuf};

use clap::{Args, ValueHint};

use crate::session::Place;

/// The structure, and whether results may be replaced. Each command has `--out` itself, as its help names the folder that is taken without it.
#[derive(Debug, Args)]
pub(crate) struct StructureArgs {
    /// Structure file (TOML); without one the built-in `paper-a` is taken
    #[arg(value_name = "STRUCTURE.toml", value_hint = ValueHint::FilePath)]
    pub(crate) path: Option<PathBuf>,
    /// Overwrite results that are there already
    #[arg(long)]
    pub(crate) force: bool,
}

impl StructureArgs {
    /// Where results go.
    pub(crate) fn place<'a>(&self, out: Option<&'a Path>, default: &'static str) -> Place<'a> {
        Place { given: out, default, force: self.force }
    }
}
