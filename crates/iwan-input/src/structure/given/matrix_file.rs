//! A matrix of a file that keys of a table name.

use iwan_machine::listed;
use std::path::{Path, PathBuf};

use iwan_exchange::{ExchangeError, Format, Matrix};

use crate::error::InputError;
use crate::section::Section;

/// Bytes that each row takes while it is read, with or without entries: its label, its places in maps of labels and nodes, its meaning and
/// its node. They are asked for because a mistyped number of rows, or that of a damaged file, would fill any memory.
const ROW: u64 = 150;

/// The error of a file that could not be read.
pub(super) fn failed(section: &Section<'_>, key: &str, error: &ExchangeError) -> InputError {
    section.failure(key, &error.to_string(), "paths are relative to the structure file").of(error.kind())
}

/// The real matrix that `key` names: the only matrix of its file, the matrix named by `KEY_name`, or a matrix with a usual name.
pub(super) fn chosen(
    section: &Section<'_>,
    folder: &Path,
    key: &str,
    usual: &[&str],
) -> Result<(PathBuf, Matrix), InputError> {
    let path = folder.join(section.text(key)?);
    let format = section.choice("format", Format::ALL)?;
    let mut matrices = iwan_exchange::read(&path, format).map_err(|error| failed(section, key, &error))?;
    let names: Vec<String> = matrices.iter().map(|matrix| matrix.name.clone()).collect();
    let of = |wanted: &str| names.iter().position(|name| name.eq_ignore_ascii_case(wanted));
    let name_key = format!("{key}_name");
    let at = match section.optional_text(&name_key)? {
        Some(wanted) => of(&wanted).ok_or_else(|| {
            let message = format!("{name_key} = \"{wanted}\": {} has no matrix of that name", path.display());
            section.failure(&name_key, &message, &format!("choose one of {}", listed(&names)))
        })?,
        None if matrices.len() == 1 => 0,
        None => usual.iter().find_map(|name| of(name)).ok_or_else(|| {
            let message = format!("{} has the matrices {}", path.display(), listed(&names));
            section.failure(key, &message, &format!("choose one with {name_key} = \"NAME\""))
        })?,
    };
    let matrix = matrices.swap_remove(at);
    if matrix.complex {
        let message = format!("{}: {} is a matrix of complex numbers", path.display(), matrix.name);
        return Err(section.failure(key, &message, "structures take real matrices: choose one"));
    }
    let what = format!("{}: a matrix of {} x {}", path.display(), matrix.rows, matrix.columns);
    let remedy = "correct the numbers of rows and columns in the file";
    iwan_machine::memory::ask(what, ROW * matrix.rows.max(matrix.columns) as u64, remedy).map_err(
        |short| {
            let InputError { message, remedy, kind } = short.into();
            section.failure(key, &message, &remedy).of(kind)
        },
    )?;
    Ok((path, matrix))
}
