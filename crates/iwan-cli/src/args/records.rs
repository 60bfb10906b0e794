//! Options of the commands that work on records.

use std::path::PathBuf;

use clap::{Args, ValueEnum, ValueHint};
use iwan_ident::Parameter;

use super::{Common, Format};

/// Extract amplitude, frequency and damping of a ring-down against time
///
/// Reads a record (CSV, NPY/NPZ, UFF/UNV dataset 58 and 58b, MATLAB v5), isolates one mode by a zero-phase band-pass,
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
  iwan envelope hammer.mat --time HIdata.time --channel HIdata.acc1 --band 60:105
  iwan envelope tap.npy --rate 12800 --quantity velocity    no time in the file
  iwan envelope tap.uff --shapes shapes.csv                 modal filter: one row a mode, one column a channel
  iwan envelope tap.csv --json --quiet | jq '.modes[0].spread'";

/// Fit a modal Iwan joint to measured ring-downs, with intervals and a verdict
///
/// Reads one or several records (several force levels of the same structure are fitted jointly), isolates each mode,
/// and finds small-amplitude frequency, viscous damping ratio, K_T, F_S, chi and beta by simulation in the loop. Every
/// parameter comes with its 95 % interval by profile likelihood, open where the records do not bound it, and the fit with a
/// verdict on whether one four-parameter joint explains damping and frequency together. Writes fit.json, summary.json,
/// scenario.toml (which `iwan simulate` runs), report.html (figures), curves.csv and response.csv into one folder.
#[derive(Debug, Args)]
#[command(after_help = FIT_EXAMPLES)]
pub(crate) struct FitArgs {
    /// Files with the records, one for each force level
    #[arg(value_name = "RECORD", required = true, value_hint = ValueHint::FilePath)]
    pub(crate) fit: Vec<PathBuf>,
    /// Folder for the results; without it `iwan-fit`, or the next free number behind it
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub(crate) out: Option<PathBuf>,
    /// Keep a parameter at a value instead of seeking it, as in damping_ratio=0; repeat it for several
    #[arg(long, value_name = "NAME=VALUE", value_parser = held)]
    pub(crate) hold: Vec<(Parameter, f64)>,
    /// Method of the curves and of the verdict; the report shows them all
    #[arg(long, value_enum, default_value_t = MethodChoice::Hilbert)]
    pub(crate) method: MethodChoice,
    /// Format of curves and response
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

const FIT_EXAMPLES: &str = "\
Examples:
  iwan fit tap.csv                                          one record, the strongest mode, all automatic
  iwan fit soft.csv hard.csv --band 60:105 --out mode1      two force levels of one mode, fitted jointly
  iwan fit hammer.mat --time HIdata.time --channel HIdata.acc1 --band 60:105
  iwan fit tap.uff --shapes shapes.csv                      every mode of the file of mode shapes
  iwan fit tap.csv --hold damping_ratio=0                   what comes out if all damping is friction
  iwan simulate iwan-fit/scenario.toml                      the fitted model, simulated
  iwan fit tap.csv --json --quiet | jq '.modes[0].k_t'";

/// What is in a record and which mode is wanted.
#[derive(Debug, Args)]
#[command(next_help_heading = "The record")]
pub(crate) struct RecordArgs {
    /// Name of the time vector: a column, a variable or a struct field such as HIdata.time
    #[arg(long, value_name = "NAME")]
    pub(crate) time: Option<String>,
    /// Name of a channel; repeat it for several [default: all that fit]
    #[arg(long = "channel", value_name = "NAME")]
    pub(crate) channels: Vec<String>,
    /// What the channels measure [default: what the file says, else acceleration]
    #[arg(long, value_enum)]
    pub(crate) quantity: Option<Motion>,
    /// Sampling rate in Hz, for files without time; goes before what the file says
    #[arg(long, value_name = "HZ", value_parser = positive)]
    pub(crate) rate: Option<f64>,
    /// Interpolate unevenly sampled records onto an even grid instead of refusing them
    #[arg(long)]
    pub(crate) resample: bool,
    /// Band of the mode in Hz; repeat it for several modes [default: around the highest spectral peak]
    #[arg(long = "band", value_name = "LOW:HIGH", value_parser = band)]
    pub(crate) bands: Vec<(f64, f64)>,
    /// Mass-normalised mode shapes as text: a header of channel names, one row for each mode; a column `frequency` (Hz)
    /// says where each mode is
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) shapes: Option<PathBuf>,
    /// Modal mass behind the record, for records that are not mass-normalised: q = sqrt(mass) x [default: 1]
    #[arg(long, value_name = "MASS", value_parser = positive, conflicts_with = "shapes")]
    pub(crate) mass: Option<f64>,
    /// Force on the axis of dissipation against force: of the joint alone, or the whole modal force
    #[arg(long, value_enum, default_value_t = Axis::Modal)]
    pub(crate) force_axis: Axis,
}

/// Ways to amplitude and frequency.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum MethodChoice {
    /// Analytic signal and polynomials
    Hilbert,
    /// Peaks, zero crossings and cubic splines
    Peaks,
    /// Peak finding and fitting
    Pff,
}

/// Kinds of motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Motion {
    /// Second derivative of displacement
    Acceleration,
    /// First derivative of displacement
    Velocity,
    /// Displacement
    Displacement,
}

/// Forces on the axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Axis {
    /// The joint's force
    Joint,
    /// The whole modal force
    Modal,
}

/// A finite number > 0.
fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value > 0.0 => Ok(value),
        _ => Err("must be a finite number > 0".into()),
    }
}

/// `LOW:HIGH` in Hz.
fn band(text: &str) -> Result<(f64, f64), String> {
    let wrong = || "must be LOW:HIGH in Hz with 0 < LOW < HIGH, as in 60:105".to_string();
    let (low, high) = text.split_once(':').ok_or_else(wrong)?;
    match (positive(low), positive(high)) {
        (Ok(low), Ok(high)) if low < high => Ok((low, high)),
        _ => Err(wrong()),
    }
}

/// `NAME=VALUE` of a parameter.
fn held(text: &str) -> Result<(Parameter, f64), String> {
    let names = Parameter::ALL.map(Parameter::name).join(", ");
    let wrong = || format!("must be NAME=VALUE with one of {names}");
    let (name, value) = text.split_once('=').ok_or_else(wrong)?;
    let parameter = Parameter::ALL.into_iter().find(|p| p.name() == name.trim()).ok_or_else(wrong)?;
    let value: f64 = value.trim().parse().map_err(|_| wrong())?;
    let (fits, range) = match parameter {
        Parameter::Frequency | Parameter::KT | Parameter::FS => (value > 0.0, "> 0"),
        Parameter::DampingRatio => ((0.0..1.0).contains(&value), ">= 0 and < 1"),
        Parameter::Chi => (value > -1.0 && value < 1.0, "> -1 and < 1"),
        Parameter::Beta => (value >= 0.0, ">= 0"),
    };
    if fits && value.is_finite() {
        Ok((parameter, value))
    } else {
        Err(format!("{name} must be finite and {range}"))
    }
}
