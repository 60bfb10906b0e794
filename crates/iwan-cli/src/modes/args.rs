//! Options of `iwan modes`.

use std::num::NonZeroUsize;

use clap::Args;

use crate::args::Common;
use crate::structures::StructureArgs;

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
