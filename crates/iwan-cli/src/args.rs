//! The command line. Doc comments are the help text.

mod records;
mod structures;

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum, ValueHint};

use crate::reproduce::ReproduceArgs;
use crate::scenario::{Overrides, Representation};
pub(crate) use records::{Axis, EnvelopeArgs, FitArgs, MethodChoice, Motion, RecordArgs};
pub(crate) use structures::{ModesArgs, QuasiStaticArgs, StructureArgs};

/// Ring-down of bolted structures with Iwan friction models
#[derive(Debug, Parser)]
#[command(name = "iwan", version, propagate_version = true, after_help = EXAMPLES)]
pub(crate) struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub(crate) command: Command,
}

const EXAMPLES: &str = "\
Examples:
  iwan simulate                              the built-in example: the paper's beam
  iwan scenario paper-modal > beam.toml      a scenario file to start from
  iwan simulate beam.toml --out beam         your own: beam/report.html shows the result
  iwan envelope hammer.mat --out mode1       amplitude, frequency and damping of a measured ring-down
  iwan fit hammer.mat --out mode1            the joint's parameters from it, with intervals
  iwan modes structure.toml --out modes      frequencies and shapes of a finite-element structure
  iwan reproduce                             the paper's tables and figures beside ours

Exit codes: 0 success, 1 the computation failed, 2 bad usage or input.";

/// The commands.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    Simulate(SimulateArgs),
    Envelope(EnvelopeArgs),
    Fit(FitArgs),
    Modes(ModesArgs),
    QuasiStatic(QuasiStaticArgs),
    Reproduce(ReproduceArgs),
    Scenario(ScenarioArgs),
    Completions(CompletionsArgs),
    Man(ManArgs),
}

/// Simulate the response of modes with Iwan joints to a force
///
/// Reads a scenario (modes, force, time axis, method), integrates every mode, superposes the modes at the
/// named points, and writes response.csv, summary.json, report.html (figures) and scenario.toml (the run as
/// it was, to be repeated) into one folder. The summary goes to standard output, everything else to standard
/// error.
#[derive(Debug, Args)]
#[command(after_help = SIMULATE_EXAMPLES)]
pub(crate) struct SimulateArgs {
    /// Scenario file (TOML); without one the built-in `paper-modal` runs
    #[arg(value_name = "SCENARIO.toml", value_hint = ValueHint::FilePath)]
    pub(crate) scenario: Option<PathBuf>,
    /// Folder for the results; without it `iwan-simulate`, or the next free number behind it
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub(crate) out: Option<PathBuf>,
    /// Format of the response
    #[arg(long, value_enum, default_value_t = Format::Csv)]
    pub(crate) format: Format,
    /// Overwrite results that are there already
    #[arg(long)]
    pub(crate) force: bool,
    #[command(flatten)]
    pub(crate) common: Common,
    #[command(flatten)]
    pub(crate) changes: Changes,
}

const SIMULATE_EXAMPLES: &str = "\
Examples:
  iwan simulate                                    the built-in example
  iwan simulate beam.toml --out beam               your own scenario
  iwan simulate beam.toml --method half-cycle      another method than the scenario's
  iwan simulate beam.toml --joint continuum        no sliders: the exact continuum
  iwan simulate --amplitude 1000 --duration 0.5    a harder blow, a longer record
  iwan simulate --json --quiet | jq '.modes[0].slip_ratio'
  iwan simulate beam.toml --format npz             for numpy.load";

/// Options of every computing command.
#[derive(Debug, Args)]
pub(crate) struct Common {
    /// Print the summary as one JSON object
    #[arg(long)]
    pub(crate) json: bool,
    /// No progress, notes or warnings on standard error; errors still appear
    #[arg(long, short)]
    pub(crate) quiet: bool,
    /// Number of threads [default: all cores]; the results do not depend on it
    #[arg(long, value_name = "N")]
    pub(crate) threads: Option<NonZeroUsize>,
}

impl Common {
    /// Number of threads to use.
    pub(crate) fn thread_count(&self) -> usize {
        let given = self.threads.or_else(|| std::thread::available_parallelism().ok());
        given.map_or(1, NonZeroUsize::get)
    }
}

/// Changes to the scenario for this run.
#[derive(Debug, Args)]
#[command(next_help_heading = "Changes to the scenario")]
pub(crate) struct Changes {
    /// Method of integration
    #[arg(long, value_enum)]
    method: Option<MethodName>,
    /// Representation of the joint in Newmark's method
    #[arg(long, value_enum)]
    joint: Option<Representation>,
    /// Number of sliders
    #[arg(long, value_name = "N")]
    sliders: Option<NonZeroUsize>,
    /// Time step, s
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    step: Option<f64>,
    /// Length of the response, s
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    duration: Option<f64>,
    /// Amplitude of the force
    #[arg(long, value_name = "FORCE", value_parser = finite, allow_negative_numbers = true)]
    amplitude: Option<f64>,
}

impl Changes {
    /// The changes in the scenario's terms.
    pub(crate) fn overrides(&self) -> Overrides {
        Overrides {
            method: self.method.map(MethodName::name),
            joint: self.joint,
            sliders: self.sliders.map(NonZeroUsize::get),
            step: self.step,
            duration: self.duration,
            amplitude: self.amplitude,
        }
    }
}

/// Methods of integration.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum MethodName {
    /// Newmark time stepping
    Newmark,
    /// Half-cycle energy map for the free decay
    HalfCycle,
    /// Averaging for the free decay: approximate
    Averaging,
    /// Event-driven exact solution: the reference, slow
    Event,
}

impl MethodName {
    const fn name(self) -> &'static str {
        match self {
            Self::Newmark => "newmark",
            Self::HalfCycle => "half-cycle",
            Self::Averaging => "averaging",
            Self::Event => "event",
        }
    }
}

/// Formats of the response.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// Text, for everything
    Csv,
    /// NumPy's archive of arrays
    Npz,
    /// Apache Parquet
    Parquet,
}

/// Print a built-in scenario or structure file as a start for your own
///
/// Without a name the built-in files are listed.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  iwan scenario --list\n  iwan scenario paper-modal > beam.toml\n  \
    iwan scenario paper-a > structure.toml\n  \
    iwan scenario --schema structure > structure.schema.json")]
pub(crate) struct ScenarioArgs {
    /// Name of the scenario or structure
    pub(crate) name: Option<String>,
    /// List the built-in files
    #[arg(long, conflicts_with = "name")]
    list: bool,
    /// Print the JSON Schema of scenario files, or of structure files, for editors and checks
    #[arg(long, value_enum, value_name = "OF", num_args = 0..=1, default_missing_value = "scenario",
        conflicts_with_all = ["name", "list"])]
    pub(crate) schema: Option<SchemaOf>,
}

/// Formats with a JSON Schema.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum SchemaOf {
    /// Scenario files
    Scenario,
    /// Structure files
    Structure,
}

/// Print completions for a shell
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  iwan completions bash > ~/.local/share/bash-completion/completions/iwan")]
pub(crate) struct CompletionsArgs {
    /// Shell
    pub(crate) shell: clap_complete::Shell,
}

/// Print a manual page
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  iwan man > iwan.1\n  iwan man simulate | man -l -")]
pub(crate) struct ManArgs {
    /// Command; without one the page of `iwan` itself
    pub(crate) command: Option<String>,
}

/// A finite number.
fn finite(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err("must be a finite number".into()),
    }
}

/// A finite number of seconds > 0.
fn seconds(text: &str) -> Result<f64, String> {
    finite(text).ok().filter(|s| *s > 0.0).ok_or_else(|| "must be a finite number of seconds > 0".into())
}
