//! `iwan completions`: completions for a shell.

use clap::{Args, Command};

use crate::failure::Failure;
use crate::output;

/// Print completions for a shell
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  iwan completions bash > ~/.local/share/bash-completion/completions/iwan")]
pub(crate) struct CompletionsArgs {
    /// Shell
    shell: clap_complete::Shell,
}

/// Prints the completions of the whole command line.
pub(crate) fn run(args: &CompletionsArgs, whole: &mut Command) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, whole, "iwan", &mut script);
    output::result(&String::from_utf8_lossy(&script))
}
