//! Options of `iwan fit`.

use std::path::PathBuf;

use clap::{Args, ValueHint};
use iwan_ident::Parameter;

use super::laws::named;
use crate::args::{Common, Format, Keeping, finite, positive};
use crate::records::{MethodChoice, RecordArgs};
use crate::session::Place;

/// Fit a modal Iwan joint to ring-downs or shaker tests, with intervals and a verdict
///
/// Reads one or several records (several force levels of the same structure are fitted jointly), isolates each mode,
/// and finds small-amplitude frequency, viscous damping ratio, K_T, F_S, chi and beta by simulation in the loop. Every
/// parameter comes with its 95 % interval by profile likelihood, open where the records do not bound it, and the fit with a
/// verdict on whether one four-parameter joint explains damping and frequency together. Other laws are compared with it by
/// evidence. Writes fit.json, summary.json, scenario.toml (the Iwan joint, or the law of --law), scenario-law.toml (the chosen law, where
/// that is another), scenario-curves.toml (frequency and damping against amplitude), all of which `iwan simulate` runs, report.html
/// (figures), curves.csv and response.csv into one folder. With --sweep or --backbone a shaker's test is fitted, by itself or together with the
/// ring-downs of one mode: fit.json, summary.json, scenario.toml, report.html and curves.csv. With --coupled several modes are fitted at once, with
/// joints that they share: fit.json, summary.json, scenario.toml and report.html.
#[derive(Debug, Args)]
#[command(after_help = FIT_EXAMPLES)]
pub(crate) struct FitArgs {
    /// Files with the records, one for each force level
    #[arg(value_name = "RECORD", required_unless_present_any = ["modal", "sweeps", "backbones"], value_hint = ValueHint::FilePath)]
    pub(crate) fit: Vec<PathBuf>,
    /// Folder that `iwan modal` wrote: its mode shapes, where its modes are, and, without RECORD, the files of its hits
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath, conflicts_with_all = ["shapes", "modes"])]
    pub(crate) modal: Option<PathBuf>,
    /// Stepped-sine responses of one mode at several levels, force- or response-controlled; may be given several times, once for
    /// each day: each file has its own small drift of the linear frequency. Columns frequency (Hz), displacement, velocity or
    /// acceleration (or amplitude, a displacement), phase (rad, against the force), excitation and, where there are several,
    /// level: as `iwan frf` writes them; text, MATLAB or NumPy. Or frequency responses of a universal file, with --level
    #[arg(long = "sweep", value_name = "FILE", value_hint = ValueHint::FilePath, conflicts_with_all = ["modal", "law"])]
    pub(crate) sweeps: Vec<PathBuf>,
    /// Backbone of one mode by phase resonance; may be given several times. Columns frequency (Hz), damping_ratio and a motion as
    /// in --sweep
    #[arg(long = "backbone", value_name = "FILE", value_hint = ValueHint::FilePath, conflicts_with_all = ["modal", "law"])]
    pub(crate) backbones: Vec<PathBuf>,
    /// Force of each frequency response of a universal file, in its order: a ratio does not say it
    #[arg(long = "level", value_name = "FORCE", value_parser = positive, requires = "sweeps")]
    pub(crate) levels: Vec<f64>,
    /// All modes at once, with joints that they share: several modes of several records, compared with joints of their own and with linear
    /// modes. Modes are those of --band, --mode or --shapes; the records are free decays, or hold the force in the channel of --load
    #[arg(long, conflicts_with_all = ["sweeps", "backbones", "law", "modal", "hold"])]
    pub(crate) coupled: bool,
    /// Channel of the force in each record, for --coupled
    #[arg(long, value_name = "NAME", requires = "coupled")]
    pub(crate) load: Option<String>,
    /// Mass-normalised shape of each mode at the force, in the order of the modes, where it is known: for --coupled
    #[arg(long, value_name = "PHI", value_parser = finite, allow_negative_numbers = true, value_delimiter = ',', requires = "load")]
    pub(crate) shape_at_force: Vec<f64>,
    /// Record that is kept out of a coupled fit and predicted; may be given several times
    #[arg(long = "held-out", value_name = "RECORD", value_hint = ValueHint::FilePath, requires = "coupled")]
    pub(crate) held_out: Vec<PathBuf>,
    /// Folder for the results; without it `iwan-fit`, or the next free number behind it
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub(crate) out: Option<PathBuf>,
    /// Keep a parameter at a value instead of seeking it, as in damping_ratio=0; repeat it for several
    #[arg(long, value_name = "NAME=VALUE", value_parser = held)]
    pub(crate) hold: Vec<(Parameter, f64)>,
    /// Law of scenario.toml and of `law` in place of the chosen one: linear, duffing, viscous-coulomb-quadratic, separate-powers, iwan,
    /// curves and others that the table of laws names
    #[arg(long, value_name = "NAME", value_parser = named)]
    pub(crate) law: Option<String>,
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
    pub(crate) keeping: Keeping,
    #[command(flatten)]
    pub(crate) records: RecordArgs,
}

const FIT_EXAMPLES: &str = "\
Examples:
  iwan fit tap.csv                                          one record, the strongest mode, all automatic
  iwan fit soft.csv hard.csv --band 60:105 --out mode1      two force levels of one mode, fitted jointly
  iwan fit hammer.mat --time HIdata.time --channel HIdata.acc1 --band 60:105
  iwan fit tap.uff --shapes shapes.csv                      every mode of the file of mode shapes
  iwan fit --modal iwan-modal --band 110:135                the hits and shapes of `iwan modal`, one of its modes
  iwan fit --sweep monday.csv --sweep tuesday.csv           stepped-sine responses of two days
  iwan fit tap.csv --sweep shaker.csv --backbone pll.csv    a ring-down, a sweep and a backbone
  iwan fit hit*.uff --checkpoint kept                       many hits, for a long time, that may be broken off
  iwan fit tap.csv --hold damping_ratio=0                   what comes out if all damping is friction
  iwan fit tap.csv --law separate-powers                    scenario.toml by another law than the Iwan joint
  iwan fit hit-1.csv hit-2.csv --coupled --band 115:130 --band 235:250 --held-out hit-3.csv
  iwan simulate iwan-fit/scenario.toml                      the fitted model, simulated
  iwan fit tap.csv --json --quiet | jq '.modes[0].k_t'";

impl FitArgs {
    /// Where results go.
    pub(super) fn place(&self) -> Place<'_> {
        Place { given: self.out.as_deref(), default: "iwan-fit", force: self.force }
    }
}

/// Reads `NAME=VALUE` as a parameter and the value at which it is held.
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
