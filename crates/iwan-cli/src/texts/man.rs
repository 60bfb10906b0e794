//! `iwan man`: manual pages.

use clap::{Args, Command};

use crate::failure::Failure;
use crate::output;

/// Print a manual page
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  iwan man > iwan.1\n  iwan man simulate | man -l -")]
pub(crate) struct ManArgs {
    /// Command; without one the page of `iwan` itself
    command: Option<String>,
}

/// Prints the page of the whole command line, or of one of its commands.
pub(crate) fn run(args: &ManArgs, mut whole: Command) -> Result<(), Failure> {
    whole.build();
    let page = match &args.command {
        None => whole,
        Some(name) => whole.find_subcommand(name).cloned().ok_or_else(|| {
            let known: Vec<_> = whole.get_subcommands().map(Command::get_name).collect();
            Failure::input(
                format!("there is no command \"{name}\""),
                format!("choose one of {}", known.join(", ")),
            )
        })?,
    };
    let mut text = Vec::new();
    clap_mangen::Man::new(page)
        .render(&mut text)
        .map_err(|error| Failure::computation(format!("the manual page: {error}")))?;
    output::result(&String::from_utf8_lossy(&text))
}
