//! The command `iwan` as a function, which both the program and the Python package call.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "numbers of samples, pixels and digits are small and not negative"
)]

// What everything stands on: texts as they may be shown, how a command fails and what it prints, threads, progress and Ctrl-C.
mod shown;
mod failure;
mod output;
mod progress;

// What commands share: their options, one run from folder to last line, and pages with figures.
mod args;
mod session;
mod page;

// What commands work on: measured records, modes identified from them, structures.
mod records;
mod identified;
mod structures;

// The commands that compute, each in its room.
mod modes;
mod quasi_static;
mod update;
mod simulate;
mod frf;
mod backbone;
mod envelope;
mod modal;
mod fit;
mod reproduce;

// The commands that only print a text.
mod texts;

// The entrances: the page of a fit, a shaker's test and records of several modes for other programs, and the command line.
mod fit_page;
mod sweep_test;
mod coupled_test;
mod cli;

pub use cli::run;
pub use coupled_test::{CoupledTest, ModesSought, StruckRecord};
pub use fit_page::{FittedMode, FittedRecord, fit_json, fit_page};
pub use sweep_test::{SweepKind, SweepSource, SweepTest};
