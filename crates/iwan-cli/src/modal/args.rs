//! Options of `iwan modal`.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::{Args, ValueEnum, ValueHint};
use iwan_modal::measure::Freedom;

use crate::args::{Common, finite, positive};
use crate::records::{Motion, band};
use crate::session::Place;

/// Find modes from hits of a hammer: frequencies, damping, mass-normalised shapes, with standard deviations
///
/// Reads force and responses of many points (UFF/UNV dataset 58 with nodes and directions, CSV and other text, MATLAB, NPZ; measured
/// frequency responses as dataset 58 functions), finds the hits in long records, says what is wrong with them, and fits the modes of all
/// responses together. Writes modal.json, frf.csv, shapes.csv (for `iwan fit --shapes`), shapes.uff, geometry.unv (where points have positions) and report.html into one folder.
#[derive(Debug, Args)]
#[command(after_help = MODAL_EXAMPLES)]
#[allow(clippy::struct_excessive_bools, reason = "each is a switch of its own on the command line")]
pub(crate) struct ModalArgs {
    /// Files with hits, or with frequency responses
    #[arg(value_name = "FILES", required = true, value_hint = ValueHint::FilePath)]
    pub(crate) files: Vec<PathBuf>,
    /// Folder for the results; without it `iwan-modal`, or the next free number behind it
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub(crate) out: Option<PathBuf>,
    /// Overwrite results that are there already
    #[arg(long)]
    pub(crate) force: bool,
    /// Channel of the hammer [default: the one that measures a force]
    #[arg(long, value_name = "NAME")]
    pub(crate) hammer: Option<String>,
    /// The files hold free decays from their first sample on, or from --from on, and no force: shapes have no scale then
    #[arg(long, conflicts_with_all = ["hammer", "at", "exponential"])]
    pub(crate) free: bool,
    /// With --free: where the decay begins, s from the first sample
    #[arg(long, value_name = "S", value_parser = positive, requires = "free")]
    pub(crate) from: Option<f64>,
    /// Where the hammer hits, POINT or POINT:DIRECTION as in 54:-z [default: what file or table say]
    #[arg(long, value_name = "POINT", value_parser = freedom)]
    pub(crate) at: Option<Freedom>,
    /// Table (TOML) of channels with points, directions and roles, and of points with positions; or a universal file with points (dataset 15 or
    /// 2411) and lines (82 or 2412)
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) points: Option<PathBuf>,
    /// Name of the time vector
    #[arg(long, value_name = "NAME")]
    pub(crate) time: Option<String>,
    /// Sampling rate in Hz, for files without time; goes before what the file says
    #[arg(long, value_name = "HZ", value_parser = positive)]
    pub(crate) rate: Option<f64>,
    /// What the sensors measure [default: what the file says, else acceleration]
    #[arg(long, value_enum)]
    pub(crate) quantity: Option<Motion>,
    /// Hits to leave out, by the name that messages give them, or `faulty` for all with a fault; repeat it for several
    #[arg(long, value_name = "HIT")]
    pub(crate) leave_out: Vec<String>,
    /// Level of force whose modes are reported, the softest is 1; all levels are compared
    #[arg(long, value_name = "N", default_value = "1")]
    pub(crate) level: NonZeroUsize,
    /// How hits are averaged: noise on the responses (h1), on the force (h2), on both (hv)
    #[arg(long, value_enum, default_value_t = EstimatorChoice::H1)]
    pub(crate) estimator: EstimatorChoice,
    /// Decay of an exponential window, 1/s: put on hits, known to be on measured frequency responses. Its damping is taken off again [default: 0, none is needed]
    #[arg(long, value_name = "DECAY", value_parser = finite)]
    pub(crate) exponential: Option<f64>,
    /// With frequency responses: time from the begin of their records to the hit, s. It matters where the records ended before the decay did [default: 0]
    #[arg(long, value_name = "S", value_parser = positive)]
    pub(crate) pretrigger: Option<f64>,
    /// Take the force as measured from end to end, noise after the pulse included
    #[arg(long)]
    pub(crate) whole_force: bool,
    /// Band in Hz [default: from ten cycles in a record to where the force has fallen by 30 dB]
    #[arg(long, value_name = "LOW:HIGH", value_parser = band)]
    pub(crate) band: Option<(f64, f64)>,
    /// How poles are looked for: a stabilisation chart, one mode after another, or with --free by subspaces of the samples
    #[arg(long, value_enum, default_value_t = WayChoice::Chart)]
    pub(crate) method: WayChoice,
    /// Look for the poles by another way as well, and set both beside each other
    #[arg(long)]
    pub(crate) compare: bool,
    /// Spread (standard deviation) of the sensors' calibrations in %, which then counts in the standard deviations of the shapes
    #[arg(long, value_name = "PERCENT", value_parser = positive)]
    pub(crate) calibration: Option<f64>,
    /// Highest order of the stabilisation chart
    #[arg(long, value_name = "N", default_value = "60")]
    pub(crate) order: NonZeroUsize,
    /// Frequencies of the modes in Hz, instead of looking for them: as in 120,245.5
    #[arg(long, value_name = "HZ,…", value_parser = positive, value_delimiter = ',')]
    pub(crate) poles: Vec<f64>,
    /// Frequencies in Hz at which modes are added to those that were found, as poles of the chart that were not taken
    #[arg(long, value_name = "HZ,…", value_parser = positive, value_delimiter = ',', conflicts_with = "poles")]
    pub(crate) add_poles: Vec<f64>,
    /// Frequencies in Hz of modes that were found and are left out again
    #[arg(long, value_name = "HZ,…", value_parser = positive, value_delimiter = ',', conflicts_with = "poles")]
    pub(crate) drop_poles: Vec<f64>,
    #[command(flatten)]
    pub(crate) common: Common,
}

/// Averages over hits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum EstimatorChoice {
    /// Noise on the responses averages out
    H1,
    /// Noise on the force averages out
    H2,
    /// Between both
    Hv,
}

/// Ways to the poles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum WayChoice {
    /// Least-squares complex frequency with a stabilisation chart, and isolation of what it missed
    Chart,
    /// Mode isolation alone
    Isolation,
    /// Subspaces of free decays, with --free
    Subspace,
}

const MODAL_EXAMPLES: &str = "\
Examples:
  iwan modal hits.uff --out modal                     nodes, directions and force from the file
  iwan modal hit*.csv --hammer force --at tip         all other channels are points; the hammer hits the one called tip
  iwan modal rove*.mat --points points.toml           which file and channel is which point, from a table
  iwan modal frf.uff --band 50:900                    frequency responses that were measured elsewhere
  iwan modal decay.csv --free --from 0.1              free decays without a force
  iwan modal decay.csv --free --method subspace       the same by subspaces
  iwan modal hits.uff --method isolation --order 40   mode isolation instead of the stabilisation chart
  iwan modal hits.uff --add-poles 245.5 --drop-poles 61,63.2
                                                      one mode more than were found, and two fewer
  iwan fit --modal modal                              on to the joints' parameters, mode by mode

Table of points (TOML):
  [[channel]]
  name = \"acc1\"            # as the file calls it
  file = \"hit 1.csv\"       # optional: in this file only
  point = \"12\"
  direction = \"+z\"
  role = \"response\"        # response, force or none
  [[point]]
  name = \"12\"
  position = [0.1, 0.0, 0.5]
  [[line]]
  points = [\"12\", \"13\"]   # optional: lines of the drawings";

impl ModalArgs {
    /// Where results go.
    pub(super) fn place(&self) -> Place<'_> {
        Place { given: self.out.as_deref(), default: "iwan-modal", force: self.force }
    }
}

/// Reads `POINT` or `POINT:DIRECTION`.
fn freedom(text: &str) -> Result<Freedom, String> {
    Freedom::parse(text)
        .ok_or_else(|| "must be POINT or POINT:DIRECTION with one of +x, -x, +y, -y, +z, -z".into())
}
