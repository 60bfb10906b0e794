//! `iwan scenario`: built-in scenario files as a start, and the schema of the format.

use crate::args::ScenarioArgs;
use crate::failure::Failure;
use crate::output;
use crate::scenario::{BuiltIn, SCHEMA, built_in, find};

/// Prints what was asked for.
pub(crate) fn run(args: &ScenarioArgs) -> Result<(), Failure> {
    match &args.name {
        _ if args.schema => output::result(SCHEMA),
        Some(name) => output::result(named(name)?.text),
        None => {
            let line = |b: &BuiltIn| format!("{:<16}{}\n", b.name, b.about);
            output::result(&built_in().iter().map(line).collect::<String>())
        }
    }
}

fn named(name: &str) -> Result<&'static BuiltIn, Failure> {
    find(name).ok_or_else(|| {
        let known = built_in().iter().map(|b| b.name).collect::<Vec<_>>().join(", ");
        Failure::input(format!("there is no built-in scenario \"{name}\""), format!("choose one of {known}"))
    })
}
