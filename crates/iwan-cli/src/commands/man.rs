//! `iwan man`: manual pages.

use clap::CommandFactory;

use crate::args::{Cli, ManArgs};
use crate::failure::Failure;
use crate::output;

/// Prints the page of `iwan`, or of one of its commands.
pub(crate) fn run(args: &ManArgs) -> Result<(), Failure> {
    let mut whole = Cli::command();
    whole.build();
    let page = match &args.command {
        None => whole,
        Some(name) => whole.find_subcommand(name).cloned().ok_or_else(|| {
            let known: Vec<_> = whole.get_subcommands().map(clap::Command::get_name).collect();
            Failure::input(
                format!("there is no command \"{name}\""),
                format!("choose one of {}", known.join(", ")),
            )
        })?,
    };
    let mut text = Vec::new();
    clap_mangen::Man::new(page)
        .render(&mut text)
        .map_err(|error| Failure::Computation(format!("the manual page: {error}")))?;
    output::result(&String::from_utf8_lossy(&text))
}
