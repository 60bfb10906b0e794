//! Tests on measured records, which are no part of this repository: reported as not run where they are not at hand.
//!
//! `IWAN_FIELD_DATA` names the folder that holds `field/` and `uff/`. A file of such tests has `harness = false` in its
//! Cargo.toml and ends in `field_tests! { name on "field/record.mat", ... }`.
#![allow(unreachable_pub, reason = "a module of several test programs")]

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use libtest_mimic::{Arguments, Trial};

/// The path of a record, or why there is none.
fn found(record: &str) -> Result<PathBuf, &'static str> {
    let folder = std::env::var_os("IWAN_FIELD_DATA").ok_or("IWAN_FIELD_DATA not set")?;
    let path = Path::new(&folder).join(record);
    // A file that is missing in a folder that is there is a fault, and fails the test.
    if path.parent().is_some_and(Path::is_dir) { Ok(path) } else { Err("IWAN_FIELD_DATA has no such folder") }
}

/// A test on one record, given as a path below `IWAN_FIELD_DATA`.
pub fn trial(name: &str, record: &str, test: fn(&Path)) -> Trial {
    match found(record) {
        Ok(path) => Trial::test(name, move || {
            test(&path);
            Ok(())
        }),
        Err(why) => Trial::test(name, move || Err(why.into())).with_kind(why).with_ignored_flag(true),
    }
}

/// Runs the tests as `cargo test` asks for.
pub fn run(trials: Vec<Trial>) -> ExitCode {
    libtest_mimic::run(&Arguments::from_args(), trials).exit_code()
}

/// The `main` of a file of tests on measured records.
macro_rules! field_tests {
    ($($name:ident on $record:literal),* $(,)?) => {
        fn main() -> std::process::ExitCode {
            field::run(vec![$(field::trial(stringify!($name), $record, $name)),*])
        }
    };
}
pub(crate) use field_tests;
