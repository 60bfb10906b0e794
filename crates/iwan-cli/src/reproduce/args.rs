//! Options of `iwan reproduce`.

use std::path::PathBuf;

use clap::{Args, ValueHint};

use crate::args::Common;

/// The paper's tables and figures beside ours
///
/// Computes the beam of Deaner, Allen, Starr and Segalman in two configurations under blows of 1 to 10,000 lbf, its modal
/// Iwan counterparts, and a laboratory's view of it (54 sensors, noise, suspension), and sets all tables and figures of the
/// paper beside what it found. Writes reproduce.json (every number), figures.json (every curve), curves.csv and report.html
/// into one folder; the summary goes to standard output.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct ReproduceArgs {
    /// Folder for the results; without it `iwan-reproduce`, or the next free number behind it
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub(crate) out: Option<PathBuf>,
    /// Overwrite results that are there already
    #[arg(long)]
    pub(crate) force: bool,
    #[command(flatten)]
    pub(crate) common: Common,
}

const EXAMPLES: &str = "\
Examples:
  iwan reproduce                        then open iwan-reproduce/report.html
  iwan reproduce --out paper --force    again into the same folder
  iwan reproduce --json --quiet | jq '.table_2[] | {configuration, mode, identified}'";
