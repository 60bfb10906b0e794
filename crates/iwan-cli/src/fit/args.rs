//! Options of `iwan fit`.

use std::path::PathBuf;

use clap::{Args, ValueHint};
use iwan_ident::Parameter;

use super::laws::named;
use crate::args::{Common, Format};
use crate::records::{MethodChoice, RecordArgs};
use crate::session::Place;

/// Fit a modal Iwan joint to measured ring-downs, with intervals and a verdict
///
/// Reads one or several records (several force levels of the same structure are fitted jointly), isolates each mode,
/// and finds small-amplitude frequency, viscous damping ratio, K_T, F_S, chi and beta by simulation in the loop. Every
/// parameter comes with its 95 % interval by profile likelihood, open where the records do not bound it, and the fit with a
/// verdict on whether one four-parameter joint explains damping and frequency together. Other laws are compared with it by
/// evidence. Writes fit.json, summary.json, scenario.toml (the Iwan joint, or the law of --law), scenario-law.toml (the chosen law, where
/// that is another), scenario-curves.toml (frequency and damping against amplitude), all of which `iwan simulate` runs, report.html
/// (figures), curves.csv and response.csv into one folder.
#[derive(Debug, Args)]
#[command(after_help = FIT_EXAMPLES)]
pub(crate) struct FitArgs {
    /// Files with the records, one for each force level
    #[arg(value_name = "RECORD", required_unless_present = "modal", value_hint = ValueHint::FilePath)]
    pub(crate) fit: Vec<PathBuf>,
    /// Folder that `iwan modal` wrote: its mode shapes, where its modes are, and, without RECORD, the files of its hits
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath, conflicts_with_all = ["shapes", "modes"])]
    pub(crate) modal: Option<PathBuf>,
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
    pub(crate) records: RecordArgs,
}

const FIT_EXAMPLES: &str = "\
Examples:
  iwan fit tap.csv                                          one record, the strongest mode, all automatic
  iwan fit soft.csv hard.csv --band 60:105 --out mode1      two force levels of one mode, fitted jointly
  iwan fit hammer.mat --time HIdata.time --channel HIdata.acc1 --band 60:105
  iwan fit tap.uff --shapes shapes.csv                      every mode of the file of mode shapes
  iwan fit --modal iwan-modal --band 110:135                the hits and shapes of `iwan modal`, one of its modes
  iwan fit tap.csv --hold damping_ratio=0                   what comes out if all damping is friction
  iwan fit tap.csv --law separate-powers                    scenario.toml by another law than the Iwan joint
  iwan simulate iwan-fit/scenario.toml                      the fitted model, simulated
  iwan fit tap.csv --json --quiet | jq '.modes[0].k_t'";

impl FitArgs {
    /// Where results go.
    pub(super) fn place(&self) -> Place<'_> {
        Place { given: self.out.as_deref(), default: "iwan-fit", force: self.force }
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
