//! The command `iwan` as a function: the program and the Python package run the same.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "numbers of samples, pixels and digits are small and not negative"
)]

mod args;
mod commands;
mod extraction;
mod failure;
mod fit_page;
mod identified;
mod linear;
mod output;
mod progress;
mod records;
mod report;
mod reproduce;
mod results;
mod run;
mod scenario;
mod summary;
mod truth;

use std::ffi::OsString;

use clap::Parser;

pub use fit_page::{FittedMode, FittedRecord, fit_page};

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
    let cli = match args::Cli::try_parse_from(arguments) {
        Ok(cli) => cli,
        Err(error) => {
            // Help and version go to stdout with code 0, usage errors to stderr with code 2.
            let _ = error.print();
            return u8::try_from(error.exit_code()).unwrap_or(2);
        }
    };
    match run::run(cli.command) {
        Ok(()) => 0,
        Err(failure) => {
            output::message(&failure.to_string());
            failure.code()
        }
    }
}
