//! Options of `iwan simulate`.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::{Args, ValueEnum, ValueHint};
use iwan_input::scenario::{JointChoice, Overrides, Scenario};
use iwan_input::{InputError, InputText};

use crate::args::{Common, Format, Keeping, finite};
use crate::session::Place;

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
    /// Write the response as it is computed, in memory that does not grow with its length (Newmark's method, modes without shared joints)
    #[arg(long)]
    pub(crate) stream: bool,
    /// Write every N-th sample of the response only; all figures of the summary are those of all samples
    #[arg(long, value_name = "N", default_value = "1")]
    pub(crate) every: NonZeroUsize,
    /// Overwrite results that are there already
    #[arg(long)]
    pub(crate) force: bool,
    #[command(flatten)]
    pub(crate) common: Common,
    #[command(flatten)]
    pub(crate) keeping: Keeping,
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
  iwan simulate beam.toml --format npz             for numpy.load
  iwan simulate --duration 3600 --stream --every 100    an hour, in the memory of a second
  iwan simulate structure.toml --checkpoint kept   a long transient of a structure that may be broken off";

impl SimulateArgs {
    /// The scenario of the run, with its changes.
    pub(super) fn read(&self, source: &InputText) -> Result<Scenario, InputError> {
        Scenario::read(source, &self.changes.overrides(self.stream))
    }

    /// Where results go.
    pub(super) fn place(&self) -> Place<'_> {
        Place { given: self.out.as_deref(), default: "iwan-simulate", force: self.force }
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
    joint: Option<JointName>,
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
    fn overrides(&self, streamed: bool) -> Overrides {
        Overrides {
            method: self.method.map(MethodName::name),
            joint: self.joint.map(JointName::representation),
            sliders: self.sliders.map(NonZeroUsize::get),
            step: self.step,
            duration: self.duration,
            amplitude: self.amplitude,
            streamed,
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

/// Representations of the joint.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum JointName {
    /// A population of Jenkins elements
    Sliders,
    /// The exact continuum
    Continuum,
}

impl JointName {
    const fn representation(self) -> JointChoice {
        match self {
            Self::Sliders => JointChoice::Sliders,
            Self::Continuum => JointChoice::Continuum,
        }
    }
}

/// Reads a finite number of seconds > 0.
fn seconds(text: &str) -> Result<f64, String> {
    finite(text).ok().filter(|s| *s > 0.0).ok_or_else(|| "must be a finite number of seconds > 0".into())
}
