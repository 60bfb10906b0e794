//! Which command runs.

use crate::args::Command;
use crate::commands::{completions, envelope, fit, man, modes, quasi_static, scenario, simulate};
use crate::failure::Failure;
use crate::reproduce;

/// Runs a command.
pub(crate) fn run(command: Command) -> Result<(), Failure> {
    match command {
        Command::Simulate(args) => simulate::run(&args),
        Command::Envelope(args) => envelope::run(&args),
        Command::Fit(args) => fit::run(&args),
        Command::Modes(args) => modes::run(&args),
        Command::QuasiStatic(args) => quasi_static::run(&args),
        Command::Reproduce(args) => reproduce::run(&args),
        Command::Scenario(args) => scenario::run(&args),
        Command::Completions(args) => completions::run(&args),
        Command::Man(args) => man::run(&args),
    }
}
