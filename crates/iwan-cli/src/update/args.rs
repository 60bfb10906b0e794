//! Options of `iwan update`.

use std::path::PathBuf;

use clap::{Args, ValueHint};

use crate::args::Common;
use crate::records::Motion;
use crate::structures::StructureArgs;

/// Joints of a structure from what several of its modes show
///
/// Measured are frequency and damping of several modes against amplitude; computed are the same curves of the structure from static
/// loads. Blows on several points may be given as well or instead, which are held against transients of the structure. Sought are the parameters of each group of joints, with 95 % intervals by profile likelihood, the viscous damping of each mode and,
/// on request, factors on materials and springs. Writes update.json, updated.toml (the structure with the joints found), summary.json and
/// report.html into one folder.
#[derive(Debug, Args)]
#[command(after_help = UPDATE_EXAMPLES)]
pub(crate) struct UpdateArgs {
    /// Folder for the results; without it `iwan-update`, or the next free number behind it
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) structure: StructureArgs,
    /// Curves of one or several modes: fit.json of `iwan fit`, envelope.csv of `iwan envelope`, curves.csv of `iwan quasi-static`, or a
    /// table with the columns displacement (modal, mass-normalised), frequency and damping_ratio (or dissipation). Before the file stand the
    /// structure's names of its modes, in the order of the file; may be given several times
    #[arg(long = "curves", value_name = "MODE[,MODE...]=FILE", required_unless_present = "records")]
    pub(crate) curves: Vec<String>,
    /// The same for curves that are kept out of the fit and predicted
    #[arg(long = "predict", value_name = "MODE[,MODE...]=FILE")]
    pub(crate) held_out: Vec<String>,
    /// A blow on several points from rest: a record whose channels are called as the structure's outputs or modes (`tip` or `tip.acceleration`), beside the
    /// force. Joints are then found from the motion itself, by transients of the structure with all modes, the search beginning at what the curves give where
    /// there are any; may be given several times
    #[arg(long = "records", value_name = "FILE", value_hint = ValueHint::FilePath, requires = "load")]
    pub(crate) records: Vec<PathBuf>,
    /// The same for blows that are kept out of the fit and predicted
    #[arg(long = "predict-records", value_name = "FILE", value_hint = ValueHint::FilePath, requires = "records")]
    pub(crate) held_out_records: Vec<PathBuf>,
    /// Channel of the records that holds the force on the structure's [[load]]
    #[arg(long, value_name = "CHANNEL")]
    pub(crate) load: Option<String>,
    /// What the channels of the records measure [default: what the file says, else acceleration]
    #[arg(long, value_enum)]
    pub(crate) quantity: Option<Motion>,
    /// Mode about whose frequency records and structure are compared, by the structure's name of it; repeat it for several [default: those of the curves]
    #[arg(long = "mode", value_name = "NAME")]
    pub(crate) modes: Vec<String>,
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
  iwan update beam.toml --curves bending-1=one.csv --predict bending-2=two.csv --group bolts=left,right
  iwan update beam.toml --records soft.csv --records hard.csv --load hammer --mode bending-1 --mode bending-3";
