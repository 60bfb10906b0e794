//! Options of `iwan backbone`.

use std::path::PathBuf;

use clap::{Args, ValueHint};

use crate::args::{Common, positive};
use crate::session::Place;

/// Nonlinear modes: frequency, damping and harmonics against amplitude
///
/// Reads a scenario with [[mode]], perhaps [[joint]], or [structure], or a structure file, and computes free vibration at every amplitude, kept going by a damping that gives back
/// what is lost: harmonic balance without time steps, sliders or start values. Writes backbone.csv, summary.json and
/// report.html (figures) into one folder.
#[derive(Debug, Args)]
#[command(after_help = BACKBONE_EXAMPLES)]
pub(crate) struct BackboneArgs {
    /// Scenario or structure file (TOML); without one the built-in scenario `paper-modal` runs
    #[arg(value_name = "FILE.toml", value_hint = ValueHint::FilePath)]
    pub(crate) scenario: Option<PathBuf>,
    /// Mode of a structure by name, as `iwan modes` calls it; may be given several times; without any the first three bending modes
    #[arg(long = "mode", value_name = "NAME")]
    pub(crate) modes: Vec<String>,
    /// Smallest modal amplitude [default: a thousandth of where macro-slip begins]
    #[arg(long, value_name = "Q", value_parser = positive)]
    pub(crate) from: Option<f64>,
    /// Largest modal amplitude [default: ten times where macro-slip begins]
    #[arg(long, value_name = "Q", value_parser = positive)]
    pub(crate) to: Option<f64>,
    /// Number of amplitudes, evenly spaced on a logarithmic scale
    #[arg(long, value_name = "N", default_value = "81", value_parser = clap::value_parser!(u32).range(8..=100_000))]
    pub(crate) points: u32,
    /// Highest harmonic, odd [default: that of the scenario's [sweep], else 1]
    #[arg(long, value_name = "N")]
    pub(crate) harmonics: Option<usize>,
    /// Folder for the results; without it `iwan-backbone`, or the next free number behind it
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub(crate) out: Option<PathBuf>,
    /// Overwrite results that are there already
    #[arg(long)]
    pub(crate) force: bool,
    #[command(flatten)]
    pub(crate) common: Common,
}

const BACKBONE_EXAMPLES: &str = "\
Examples:
  iwan backbone                                the built-in example: three modes of the paper's beam
  iwan backbone beam.toml --harmonics 7        with the harmonics 1, 3, 5 and 7
  iwan backbone beam.toml --from 1e-5 --to 1e-2 --out curves
  iwan backbone structure.toml --mode bending-1 --harmonics 7
  iwan backbone --json --quiet | jq '.modes[0] | {amplitude, damping_ratio}'";

impl BackboneArgs {
    /// Where results go.
    pub(super) fn place(&self) -> Place<'_> {
        Place { given: self.out.as_deref(), default: "iwan-backbone", force: self.force }
    }
}
