//! Options of the commands that work on finite-element structures.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::{Args, ValueHint};

use super::Common;

/// Linear modes of a structure with all joints stuck and with all slipping
///
/// Reads a structure (mesh, materials, joints), checks it, and computes frequencies and shapes in both limits, the joint
/// stiffness K_T of each mode, and which slipping mode resembles which stuck one. Writes modes.csv, modes.vtu (shapes for
/// ParaView), summary.json and report.html (pictures) into one folder.
#[derive(Debug, Args)]
#[command(after_help = MODES_EXAMPLES)]
pub(crate) struct ModesArgs {
    #[command(flatten)]
    pub(crate) structure: StructureArgs,
    /// Number of elastic modes
    #[arg(long, value_name = "N", default_value = "20")]
    pub(crate) count: NonZeroUsize,
    #[command(flatten)]
    pub(crate) common: Common,
}

const MODES_EXAMPLES: &str = "\
Examples:
  iwan modes                                  the built-in structure: the paper's beam, configuration A
  iwan scenario paper-a > structure.toml      a structure file to start from
  iwan modes structure.toml --out modes       your own: modes/report.html shows the result
  iwan modes --json --quiet | jq '.joint_modes[0].k_t'";

/// Modal curves of a structure from static loads, and modal Iwan parameters from them
///
/// Loads the structure statically in the shape of a mode, reads the secant frequency and, by Masing's rule, the dissipation
/// over the modal displacement, and fits a modal Iwan joint to them: what a ring-down test of that mode alone would
/// find, without any transient. Writes curves.csv, summary.json and report.html (figures) into one folder.
#[derive(Debug, Args)]
#[command(after_help = QUASI_STATIC_EXAMPLES)]
pub(crate) struct QuasiStaticArgs {
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

/// A finite number > 0.
fn positive(text: &str) -> Result<f64, String> {
    super::finite(text).ok().filter(|x| *x > 0.0).ok_or_else(|| "must be a finite number > 0".into())
}
