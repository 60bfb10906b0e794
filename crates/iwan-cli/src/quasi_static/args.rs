//! Options of `iwan quasi-static`.

use std::path::PathBuf;

use clap::{Args, ValueHint};

use crate::args::{Common, positive};
use crate::structures::StructureArgs;

/// Modal curves of a structure from static loads, and modal Iwan parameters from them
///
/// Loads the structure statically in the shape of a mode, reads the secant frequency and, by Masing's rule, the dissipation
/// over the modal displacement, and fits a modal Iwan joint to them: what a ring-down test of that mode alone would
/// find, without any transient. Writes curves.csv, summary.json, report.html (figures) and coupled.toml (a scenario in which
/// these modes share their joints, for `iwan simulate`) into one folder.
#[derive(Debug, Args)]
#[command(after_help = QUASI_STATIC_EXAMPLES)]
pub(crate) struct QuasiStaticArgs {
    /// Folder for the results; without it `iwan-quasi-static`, or the next free number behind it
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) structure: StructureArgs,
    /// Mode by name, as `iwan modes` calls it (`bending 1` or `bending-1`); may be given several times; without any the first
    /// three bending modes
    #[arg(long = "mode", value_name = "NAME")]
    pub(crate) modes: Vec<String>,
    /// Smallest modal displacement [default: a thousandth of where the first joint begins macro-slip]
    #[arg(long, value_name = "Q", value_parser = positive)]
    pub(crate) from: Option<f64>,
    /// Largest modal displacement [default: ten times where the first joint begins macro-slip]
    #[arg(long, value_name = "Q", value_parser = positive)]
    pub(crate) to: Option<f64>,
    /// Number of displacements, evenly spaced on a logarithmic scale
    #[arg(long, value_name = "N", default_value = "81", value_parser = clap::value_parser!(u32).range(8..=100_000))]
    pub(crate) points: u32,
    #[command(flatten)]
    pub(crate) common: Common,
}

const QUASI_STATIC_EXAMPLES: &str = "\
Examples:
  iwan quasi-static                                        the built-in structure: the paper's beam, configuration A
  iwan quasi-static structure.toml --out curves            your own: curves/report.html shows the result
  iwan quasi-static --mode bending-1 --from 1e-4 --to 1e-2
  iwan quasi-static --json --quiet | jq '.modes[0] | {k_t, f_s, chi, beta}'";
