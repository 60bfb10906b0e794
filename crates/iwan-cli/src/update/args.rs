//! Options of `iwan update`.

use clap::Args;

use crate::args::Common;
use crate::structures::StructureArgs;

/// Joints of a structure from what several of its modes show
///
/// Measured are frequency and damping of several modes against amplitude; computed are the same curves of the structure from static
/// loads. Sought are the parameters of each group of joints, with 95 % intervals by profile likelihood, the viscous damping of each mode and,
/// on request, factors on materials and springs. Writes update.json, updated.toml (the structure with the joints found), summary.json and
/// report.html into one folder.
#[derive(Debug, Args)]
#[command(after_help = UPDATE_EXAMPLES)]
pub(crate) struct UpdateArgs {
    #[command(flatten)]
    pub(crate) structure: StructureArgs,
    /// Curves of one or several modes: fit.json of `iwan fit`, envelope.csv of `iwan envelope`, curves.csv of `iwan quasi-static`, or a
    /// table with the columns displacement (modal, mass-normalised), frequency and damping_ratio (or dissipation). Before the file stand the
    /// structure's names of its modes, in the order of the file; may be given several times
    #[arg(long = "curves", value_name = "MODE[,MODE...]=FILE", required = true)]
    pub(crate) curves: Vec<String>,
    /// The same for curves that are kept out of the fit and predicted
    #[arg(long = "predict", value_name = "MODE[,MODE...]=FILE")]
    pub(crate) held_out: Vec<String>,
    /// Joints that share one law, by their names; without any those that move alike in the measured modes are one group each
    #[arg(long = "group", value_name = "NAME=JOINT[,JOINT...]")]
    pub(crate) groups: Vec<String>,
    /// A part of the linear stiffness that may be wrong by a factor: `material`, the element set of a material, or the name of a lump with
    /// springs; with the standard deviation of the factor's logarithm where it is known before
    #[arg(long = "correct", value_name = "PART[=SD]")]
    pub(crate) corrections: Vec<String>,
    /// No viscous damping beside the joints; without this each measured mode has its own
    #[arg(long)]
    pub(crate) undamped: bool,
    #[command(flatten)]
    pub(crate) common: Common,
}

const UPDATE_EXAMPLES: &str = "\
Examples:
  iwan update beam.toml --curves bending-1=mode1/fit.json --curves bending-3=mode3/fit.json --out updated
  iwan update beam.toml --curves bending-1,bending-2=envelope.csv --correct material=0.02
  iwan update beam.toml --curves bending-1=one.csv --predict bending-2=two.csv --group bolts=left,right";
