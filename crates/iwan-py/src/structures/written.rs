//! Writes structures as files: `Structure.write_matrices` and `Structure.write_reduced`.

use std::path::PathBuf;

use iwan_fem::NamedModes;
use iwan_input::{MatrixFormat, ReducedFolder, matrix_files};
use iwan_io::atomic::Folder;
use pyo3::prelude::*;

use crate::exchange::errors::{computation, fem, value, writing};
use crate::exchange::named;
use crate::exchange::options::unknown;
use crate::exchange::work;
use crate::structures::structure::Structure;

/// Writes the matrices into a folder.
#[pyfunction]
pub(crate) fn _write_matrices(
    structure: &Bound<'_, Structure>,
    #[pyo3(from_py_with = named::folder)] folder: PathBuf,
    #[pyo3(from_py_with = named::format)] format: &str,
    #[pyo3(from_py_with = named::force)] force: bool,
) -> PyResult<Vec<String>> {
    let format = match format {
        "matrix-market" => MatrixFormat::MatrixMarket,
        "npz" => MatrixFormat::Npz,
        "mat" => MatrixFormat::Matlab,
        _ => return Err(unknown("format", format, &["matrix-market", "npz", "mat"])),
    };
    let (py, this) = (structure.py(), structure.get().0.clone());
    let loaded = this.clone();
    let assembled = work::run(py, true, move |_| loaded.file.structure.assemble())?;
    let assembled = assembled.map_err(|error| fem(this.name(), &error))?;
    let files = matrix_files(&assembled, format).map_err(|error| computation(error.to_string()))?;
    let mut out = Folder::stage(&folder, force).map_err(|error| writing(&error))?;
    for (name, content) in &files {
        let fill = |sink: &mut std::io::BufWriter<std::fs::File>| std::io::Write::write_all(sink, content);
        out.write(name, fill).map_err(|error| writing(&error))?;
    }
    out.commit().map_err(|error| writing(&error))?;
    Ok(files.into_iter().map(|file| file.0).collect())
}

/// Writes a reduced model into a folder that opens again.
#[pyfunction]
pub(crate) fn _write_reduced(
    structure: &Bound<'_, Structure>,
    #[pyo3(from_py_with = named::folder)] folder: PathBuf,
    #[pyo3(from_py_with = named::modes)] modes: usize,
    #[pyo3(from_py_with = named::force)] force: bool,
) -> PyResult<()> {
    if modes == 0 {
        return Err(value("modes = 0 is out of range: at least 1 mode"));
    }
    let mut out = Folder::stage(&folder, force).map_err(|error| writing(&error))?;
    out.check(&ReducedFolder::FILES).map_err(|error| writing(&error))?;
    let (py, this) = (structure.py(), structure.get().0.clone());
    let loaded = this.clone();
    let kept = work::run(py, true, move |control| {
        let named = loaded.named_modes(NamedModes::LOOKED_UP, control)?;
        named.keep(modes, &|_| control.stop())
    })?;
    let kept = kept.map_err(|error| fem(this.name(), &error))?;
    let written = ReducedFolder { source: this.source(), kept: &kept };
    let [table, text, arrays] = ReducedFolder::FILES;
    let table_text = written.table(&folder);
    for (name, content) in [(table, table_text.as_str()), (text, written.structure())] {
        let fill = |sink: &mut std::io::BufWriter<std::fs::File>| {
            std::io::Write::write_all(sink, content.as_bytes())
        };
        out.write(name, fill).map_err(|error| writing(&error))?;
    }
    out.write(arrays, |sink| written.arrays(sink)).map_err(|error| writing(&error))?;
    out.commit().map_err(|error| writing(&error))
}
