//! `iwan`: ring-downs of bolted structures with Iwan friction models, from the command line.

use std::process::ExitCode;

fn main() -> ExitCode {
    iwan_cli::run(std::env::args_os()).into()
}
