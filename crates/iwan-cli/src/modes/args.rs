//! Options of `iwan modes`.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::{Args, ValueEnum, ValueHint};

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
    /// Folder for the results; without it `iwan-modes`, or the next free number behind it
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) structure: StructureArgs,
    /// Number of elastic modes
    #[arg(long, value_name = "N", default_value = "20")]
    pub(crate) count: NonZeroUsize,
    /// Also write stiffness (slipping and stuck), mass and the displacements of all nodes in the unknowns, with what each row is
    #[arg(long, value_name = "FORMAT", num_args = 0..=1, require_equals = true, default_missing_value = "matrix-market")]
    pub(crate) write_matrices: Option<Written>,
    /// Also write a reduced model of N modes and the attachment vectors: the folder then opens in place of a structure file, and as
    /// `[structure] reduced = "DIR"` in scenarios, without a factorisation. At least 40 elastic modes are computed then
    #[arg(long, value_name = "N")]
    pub(crate) write_reduced: Option<NonZeroUsize>,
    #[command(flatten)]
    pub(crate) common: Common,
}

/// Formats of matrices.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum Written {
    /// One text for each matrix (.mtx)
    MatrixMarket,
    /// As `scipy.sparse.save_npz` writes them (.npz)
    Npz,
    /// MATLAB level 5, all in one file (.mat)
    Mat,
}

const MODES_EXAMPLES: &str = "\
Examples:
  iwan modes                                  the built-in structure: the paper's beam, configuration A
  iwan scenario paper-a > structure.toml      a structure file to start from
  iwan modes structure.toml --out modes       your own: modes/report.html shows the result
  iwan modes structure.toml --write-matrices=npz --out modes      K, M and their rows for SciPy
  iwan modes large.toml --write-reduced 60 --out reduced          factored once; `[structure] reduced = \"reduced\"` from then on
  iwan modes --json --quiet | jq '.joint_modes[0].k_t'";
