//! Texts as files, whole or not at all.

use std::io::Write;
use std::path::Path;

use pyo3::prelude::*;

use crate::exchange::errors::writing;

/// Writes a text into a file, over one that is there only by `force`.
pub(crate) fn write(py: Python<'_>, path: &Path, text: &str, force: bool) -> PyResult<()> {
    let written = py.detach(|| iwan_io::atomic::write_file(path, force, |w| w.write_all(text.as_bytes())));
    written.map_err(|error| writing(&error))
}

/// The text, written into a file besides where one is named.
pub(crate) fn kept(py: Python<'_>, path: Option<&Path>, text: String, force: bool) -> PyResult<String> {
    path.map_or(Ok(()), |path| write(py, path, &text, force)).map(|()| text)
}
