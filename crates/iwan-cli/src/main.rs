//! `iwan`: ring-downs of bolted structures with Iwan friction models, from the command line.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "numbers of samples, pixels and digits are small and not negative"
)]

mod args;
mod commands;
mod cycles;
mod extraction;
mod failure;
mod identified;
mod linear;
mod output;
mod parallel;
mod progress;
mod records;
mod report;
mod results;
mod run;
mod scenario;
mod summary;
mod truth;

use std::process::ExitCode;

use clap::Parser;

fn main() -> ExitCode {
    let cli = match args::Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => {
            // Help and version go to stdout with code 0, usage errors to stderr with code 2.
            let _ = error.print();
            return ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2));
        }
    };
    match run::run(cli.command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            output::message(&failure.to_string());
            ExitCode::from(failure.code())
        }
    }
}
