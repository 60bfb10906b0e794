//! `iwan scenario`: built-in scenario and structure files as a start, and the schemas of the formats.

use iwan_input::{BUILT_IN_STRUCTURES, STRUCTURE_SCHEMA};

use crate::args::{ScenarioArgs, SchemaOf};
use crate::failure::Failure;
use crate::output;
use crate::scenario::{SCHEMA, built_in};

/// Prints what was asked for.
pub(crate) fn run(args: &ScenarioArgs) -> Result<(), Failure> {
    match (args.schema, &args.name) {
        (Some(SchemaOf::Scenario), _) => output::result(SCHEMA),
        (Some(SchemaOf::Structure), _) => output::result(STRUCTURE_SCHEMA),
        (None, Some(name)) => output::result(named(name)?),
        (None, None) => {
            let line = |(name, about, _): &File| format!("{name:<16}{about}\n");
            output::result(&files().iter().map(line).collect::<String>())
        }
    }
}

/// Name, purpose and text.
type File = (&'static str, &'static str, &'static str);

/// All files that are built in: scenarios, then structures.
fn files() -> Vec<File> {
    let scenarios = built_in().iter().map(|b| (b.name, b.about, b.text));
    scenarios.chain(BUILT_IN_STRUCTURES.iter().copied()).collect()
}

fn named(name: &str) -> Result<&'static str, Failure> {
    let files = files();
    files.iter().find(|file| file.0 == name).map(|file| file.2).ok_or_else(|| {
        let known = files.iter().map(|file| file.0).collect::<Vec<_>>().join(", ");
        Failure::input(format!("there is no built-in scenario \"{name}\""), format!("choose one of {known}"))
    })
}
