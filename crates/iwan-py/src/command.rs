//! The command `iwan`, as installed with the package.

use std::ffi::OsString;

use pyo3::prelude::*;

/// Runs the command line and returns its exit code.
#[pyfunction]
pub(crate) fn _command(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| iwan_cli::run(arguments))
}
