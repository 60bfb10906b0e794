//! Texts as files, whole or not at all.

use std::io::Write;
use std::path::{Path, PathBuf};

use pyo3::prelude::*;

use crate::exchange::errors::writing;
use crate::exchange::named;

/// Writes a text into a file, over one that is there only by `force`.
pub(crate) fn write(py: Python<'_>, path: &Path, text: &str, force: bool) -> PyResult<()> {
    let written = py.detach(|| iwan_io::atomic::write_file(path, force, |w| w.write_all(text.as_bytes())));
    written.map_err(|error| writing(&error))
}

/// Writes a text into a file of that name.
#[pyfunction]
pub(crate) fn _write_text(
    py: Python<'_>,
    #[pyo3(from_py_with = named::path)] path: PathBuf,
    text: &str,
    force: bool,
) -> PyResult<()> {
    write(py, &path, text, force)
}

/// The text, written into a file besides where one is named.
pub(crate) fn kept(py: Python<'_>, path: Option<&Path>, text: String, force: bool) -> PyResult<String> {
    path.map_or(Ok(()), |path| write(py, path, &text, force)).map(|()| text)
}
