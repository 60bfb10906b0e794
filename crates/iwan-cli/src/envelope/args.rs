//! Options of `iwan envelope`.

use std::path::PathBuf;

use clap::{Args, ValueHint};

use crate::args::{Common, Format};
use crate::records::{MethodChoice, RecordArgs};
use crate::session::Place;

/// Extract amplitude, frequency and damping of a ring-down against time
///
/// Reads a record (CSV and other text, LVM, NPY/NPZ, UFF/UNV dataset 58 and 58b, MATLAB, WAV), isolates one mode by a zero-phase band-pass,
/// and follows its amplitude and frequency by three independent methods and a cross-check; how far they disagree is part
/// of the answer. Writes envelope.csv, summary.json and report.html (figures) into one folder.
#[derive(Debug, Args)]
#[command(after_help = ENVELOPE_EXAMPLES)]
pub(crate) struct EnvelopeArgs {
    /// File with the record
    #[arg(value_name = "RECORD", value_hint = ValueHint::FilePath)]
    pub(crate) record: PathBuf,
    /// Folder for the results; without it `iwan-envelope`, or the next free number behind it
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub(crate) out: Option<PathBuf>,
    /// Only list the peaks of the spectrum: frequency, height, half-power width, damping, prominence
    #[arg(long, conflicts_with_all = ["bands", "modes", "shapes"])]
    pub(crate) peaks: bool,
    /// Method whose result goes into the files; the report shows them all
    #[arg(long, value_enum, default_value_t = MethodChoice::Hilbert)]
    pub(crate) method: MethodChoice,
    /// Format of the envelope
    #[arg(long, value_enum, default_value_t = Format::Csv)]
    pub(crate) format: Format,
    /// Overwrite results that are there already
    #[arg(long)]
    pub(crate) force: bool,
    #[command(flatten)]
    pub(crate) common: Common,
    #[command(flatten)]
    pub(crate) records: RecordArgs,
}

const ENVELOPE_EXAMPLES: &str = "\
Examples:
  iwan envelope tap.csv                                     one channel, the strongest mode, all automatic
  iwan envelope tap.csv --band 60:105 --out mode1           the mode in this band
  iwan envelope tap.csv --peaks                             which modes there are
  iwan envelope tap.csv --mode 151 --from 0.2 --to 3        the mode nearest to 151 Hz, in a part of the record
  iwan envelope hammer.mat --time HIdata.time --channel HIdata.acc1 --band 60:105
  iwan envelope tap.npy --rate 12800 --quantity velocity    no time in the file
  iwan envelope tap.uff --shapes shapes.csv                 modal filter: one row a mode, one column a channel
  iwan envelope tap.csv --json --quiet | jq '.modes[0].spread'";

impl EnvelopeArgs {
    /// Where results go.
    pub(super) fn place(&self) -> Place<'_> {
        Place { given: self.out.as_deref(), default: "iwan-envelope", force: self.force }
    }
}
