//! Options of `iwan frf`.

use std::path::PathBuf;

use clap::{Args, ValueHint};

use crate::args::Common;
use crate::session::Place;

/// Steady forced responses: amplitude and phase over frequency at given force or given response
///
/// Reads a scenario with [[mode]], perhaps [[joint]], or [structure], and [sweep] (the band, what is held and at which levels) and balances harmonics: no time
/// steps, no sliders, no start values. Every curve is followed through the frequencies at which it turns back, where a
/// measured response would jump. Writes frf.csv, frf.json and report.html (figures) into one folder.
#[derive(Debug, Args)]
#[command(after_help = FRF_EXAMPLES)]
pub(crate) struct FrfArgs {
    /// Scenario file (TOML); without one the built-in `paper-modal` runs
    #[arg(value_name = "SCENARIO.toml", value_hint = ValueHint::FilePath)]
    pub(crate) scenario: Option<PathBuf>,
    /// Folder for the results; without it `iwan-frf`, or the next free number behind it
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub(crate) out: Option<PathBuf>,
    /// Overwrite results that are there already
    #[arg(long)]
    pub(crate) force: bool,
    #[command(flatten)]
    pub(crate) common: Common,
}

const FRF_EXAMPLES: &str = "\
Examples:
  iwan frf                                     the built-in example: mode 1 of the paper's beam at four forces
  iwan scenario paper-modal > beam.toml        a scenario to start from; its [sweep] says what is asked for
  iwan frf beam.toml --out shaker              shaker/report.html shows the result
  iwan frf --json --quiet | jq '.modes[0].levels[].peak'";

impl FrfArgs {
    /// Where results go.
    pub(super) fn place(&self) -> Place<'_> {
        Place { given: self.out.as_deref(), default: "iwan-frf", force: self.force }
    }
}
