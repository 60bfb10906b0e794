//! `iwan scenario`: built-in scenario and structure files as a start, and the schemas of the formats.

use clap::{Args, ValueEnum};
use iwan_input::scenario::{SCHEMA, built_in};
use iwan_input::{BUILT_IN_STRUCTURES, STRUCTURE_SCHEMA};

use crate::failure::Failure;
use crate::output;

/// Print a built-in scenario or structure file as a start for your own
///
/// Without a name the built-in files are listed.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  iwan scenario --list\n  iwan scenario paper-modal > beam.toml\n  \
    iwan scenario paper-a > structure.toml\n  \
    iwan scenario --schema structure > structure.schema.json")]
pub(crate) struct ScenarioArgs {
    /// Name of the scenario or structure
    name: Option<String>,
    /// List the built-in files
    #[arg(long, conflicts_with = "name")]
    list: bool,
    /// Print the JSON Schema of scenario files, or of structure files, for editors and checks
    #[arg(long, value_enum, value_name = "OF", num_args = 0..=1, default_missing_value = "scenario",
        conflicts_with_all = ["name", "list"])]
    schema: Option<Format>,
}

/// Formats with a JSON Schema.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// Scenario files
    Scenario,
    /// Structure files
    Structure,
}

/// A file that is built in.
struct File {
    name: &'static str,
    /// What the file shows, in one line.
    about: &'static str,
    text: &'static str,
}

/// Prints what was asked for.
pub(crate) fn run(args: &ScenarioArgs) -> Result<(), Failure> {
    match (args.schema, &args.name) {
        (Some(Format::Scenario), _) => output::result(SCHEMA),
        (Some(Format::Structure), _) => output::result(STRUCTURE_SCHEMA),
        (None, Some(name)) => output::result(named(name)?),
        (None, None) => {
            let line = |file: &File| format!("{:<16}{}\n", file.name, file.about);
            output::result(&files().iter().map(line).collect::<String>())
        }
    }
}

/// All files that are built in: scenarios, then structures.
fn files() -> Vec<File> {
    let scenarios = built_in().iter().map(|b| File { name: b.name, about: b.about, text: b.text });
    let structures = BUILT_IN_STRUCTURES.iter().map(|&(name, about, text)| File { name, about, text });
    scenarios.chain(structures).collect()
}

fn named(name: &str) -> Result<&'static str, Failure> {
    let files = files();
    files.iter().find(|file| file.name == name).map(|file| file.text).ok_or_else(|| {
        let known = files.iter().map(|file| file.name).collect::<Vec<_>>().join(", ");
        Failure::input(format!("there is no built-in scenario \"{name}\""), format!("choose one of {known}"))
    })
}
