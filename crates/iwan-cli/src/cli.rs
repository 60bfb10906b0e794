//! The command line as a whole: the commands, and which room runs each.

use std::ffi::OsString;

use clap::{CommandFactory, Parser, Subcommand};
use iwan_machine::{Kind, memory};

use crate::backbone::{self, BackboneArgs};
use crate::envelope::{self, EnvelopeArgs};
use crate::failure::Failure;
use crate::fit::{self, FitArgs};
use crate::frf::{self, FrfArgs};
use crate::modal::{self, ModalArgs};
use crate::modes::{self, ModesArgs};
use crate::output;
use crate::progress;
use crate::quasi_static::{self, QuasiStaticArgs};
use crate::reproduce::{self, ReproduceArgs};
use crate::simulate::{self, SimulateArgs};
use crate::texts::{completions, man, scenario};
use crate::update::{self, UpdateArgs};

/// Ring-down of bolted structures with Iwan friction models
#[derive(Debug, Parser)]
#[command(name = "iwan", version, propagate_version = true, after_help = EXAMPLES)]
struct Cli {
    /// What to do.
    #[command(subcommand)]
    command: Command,
    /// Most memory to take, such as 4GB or 500MB [default: what is free]; what needs more is refused before it begins
    #[arg(long, global = true, value_name = "SIZE", value_parser = memory::parse_bytes)]
    memory: Option<u64>,
}

const EXAMPLES: &str = "\
Examples:
  iwan simulate                              the built-in example: the paper's beam
  iwan scenario paper-modal > beam.toml      a scenario file to start from
  iwan simulate beam.toml --out beam         your own: beam/report.html shows the result
  iwan frf beam.toml --out shaker            steady responses to a shaker, over frequency
  iwan envelope hammer.mat --out mode1       amplitude, frequency and damping of a measured ring-down
  iwan fit hammer.mat --out mode1            the joint's parameters from it, with intervals
  iwan modal hit*.uff --out modal            hits of a hammer to modes, with mass-normalised shapes
  iwan modes structure.toml --out modes      frequencies and shapes of a finite-element structure
  iwan reproduce                             the paper's tables and figures beside ours

Exit codes: 0 success, 1 the computation failed, 2 bad usage or input.";

/// The commands.
#[derive(Debug, Subcommand)]
enum Command {
    Simulate(SimulateArgs),
    Frf(FrfArgs),
    Backbone(BackboneArgs),
    Envelope(EnvelopeArgs),
    Modal(ModalArgs),
    Fit(FitArgs),
    Modes(ModesArgs),
    QuasiStatic(QuasiStaticArgs),
    Update(UpdateArgs),
    Reproduce(ReproduceArgs),
    Scenario(scenario::ScenarioArgs),
    Completions(completions::CompletionsArgs),
    Man(man::ManArgs),
}

/// Runs the command line `arguments`, the program's name first, and returns the exit code: 0 success, 1 the computation
/// failed, 2 bad usage or input, 130 interrupted.
///
/// Results go to standard output, everything else to standard error.
///
/// ```
/// assert_eq!(iwan_cli::run(["iwan".into(), "scenario".into(), "--list".into()]), 0);
/// assert_eq!(iwan_cli::run(["iwan".into(), "dance".into()]), 2);
/// ```
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    // `--json` is looked for before the arguments are parsed, so that programs read a usage error in the same form as any other failure.
    let json = arguments.iter().any(|argument| argument == "--json");
    let cli = match Cli::try_parse_from(arguments) {
        Ok(cli) => cli,
        Err(error) => {
            // Help and version go to stdout with code 0, usage errors to stderr with code 2.
            if !error.use_stderr() {
                let _ = error.print();
                return 0;
            }
            let text = error.to_string();
            output::message(text.trim_end());
            if json {
                let message = text.strip_prefix("error: ").unwrap_or(&text).trim_end();
                told(&Failure::input(message, "").of(Kind::Usage));
            }
            return 2;
        }
    };
    progress::begun();
    memory::set_limit(cli.memory.unwrap_or(u64::MAX));
    memory::watch(move |short| {
        let failure = Failure::from(short);
        progress::end(&failure, &|| {
            if json {
                told(&failure);
            }
        });
    });
    let outcome = command(cli.command);
    let _ending = progress::ending();
    progress::ended();
    match outcome {
        Ok(()) => 0,
        Err(failure) => {
            output::message(&failure.to_string());
            // With --strict the summary with its warnings has been printed already; no second JSON object follows it.
            if json && failure.kind() != Kind::Strict {
                told(&failure);
            }
            failure.code()
        }
    }
}

/// Prints a failure as JSON on standard output, for programs.
fn told(failure: &Failure) {
    // Where standard output cannot be written, the message on standard error and the exit code remain.
    let _ = output::result(&failure.json());
}

/// Runs one command.
fn command(command: Command) -> Result<(), Failure> {
    if !matches!(command, Command::Scenario(_) | Command::Completions(_) | Command::Man(_)) {
        memory::ask_to_begin()?;
    }
    match command {
        Command::Simulate(args) => simulate::run(&args),
        Command::Frf(args) => frf::run(&args),
        Command::Backbone(args) => backbone::run(&args),
        Command::Envelope(args) => envelope::run(&args),
        Command::Modal(args) => modal::run(&args),
        Command::Fit(args) => fit::run(args),
        Command::Modes(args) => modes::run(&args),
        Command::QuasiStatic(args) => quasi_static::run(&args),
        Command::Update(args) => update::run(&args),
        Command::Reproduce(args) => reproduce::run(&args),
        Command::Scenario(args) => scenario::run(&args),
        Command::Completions(args) => completions::run(&args, &mut Cli::command()),
        Command::Man(args) => man::run(&args, Cli::command()),
    }
}
