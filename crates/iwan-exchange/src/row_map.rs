//! Files beside the matrices: which degree of freedom each row is, and where the nodes are.

use std::path::Path;

use crate::error::ExchangeError;
use crate::matrix::{Component, Label};
use crate::packed::netcdf;
use crate::source::{Line, Source};
use crate::text::{calculix, sierra};

fn bytes(file: &Path) -> Result<Vec<u8>, ExchangeError> {
    iwan_machine::read_file(file).map_err(|source| ExchangeError::Io { file: file.into(), source })
}

/// Reads which degree of freedom each row of a matrix is. The file is CalculiX `.dof`, Sierra/SD `ASetMap.m` (with its `gid.m` as
/// `numbers`), or a text with a line `node, component` for each row; the component is 1 to 6, `x` to `rz`, or 0 for a generalised
/// coordinate. Lines that begin with `#` are comments; a line of words at the top is passed over.
///
/// # Errors
/// [`ExchangeError`] names the file, the line, what stands there and what is allowed.
pub fn read_rows(path: impl AsRef<Path>, numbers: Option<&Path>) -> Result<Vec<Label>, ExchangeError> {
    let file = path.as_ref();
    let content = bytes(file)?;
    let source = Source { file, bytes: &content };
    let extension = file.extension().unwrap_or_default().to_ascii_lowercase();
    if extension == "m" {
        let second = numbers.map(|file| Ok::<_, ExchangeError>((file, bytes(file)?))).transpose()?;
        let numbers = second.as_ref().map(|(file, bytes)| Source { file, bytes });
        return sierra::rows(&source, numbers.as_ref());
    }
    if extension == "dof" {
        return calculix::rows(&source);
    }
    let mut rows = Vec::new();
    for (n, line) in source.lines().filter(|line| !line.text.starts_with(b"#")).enumerate() {
        if n == 0 && line.text.first().is_some_and(u8::is_ascii_alphabetic) {
            continue;
        }
        rows.push(row(&source, &line)?);
    }
    if rows.is_empty() { Err(source.ends("a line `node, component` for each row")) } else { Ok(rows) }
}

fn row(source: &Source, line: &Line) -> Result<Label, ExchangeError> {
    const WORDS: [&[u8]; 7] = [b"0", b"x", b"y", b"z", b"rx", b"ry", b"rz"];
    let Some([node, component]) = line.exactly() else {
        return Err(source.malformed(line.place(), line.quoted(), "node, component"));
    };
    let node = source.whole(line, node, [0, u64::MAX], "the node")?;
    let word = WORDS.iter().position(|word| word.eq_ignore_ascii_case(component));
    let number = match word {
        Some(number) => number as u64,
        None => source.whole(line, component, [0, 6], "the component (or x, y, z, rx, ry, rz)")?,
    };
    Ok(Label { node, component: Component::numbered(number).unwrap_or(Component::Scalar) })
}

/// Reads positions of nodes: an Exodus or other netCDF classic file that has `coordx` and `node_num_map`, or a text with lines `node, x, y,
/// z`. Comments and words are as in [`read_rows`].
///
/// # Errors
/// As [`read_rows`].
pub fn read_positions(path: impl AsRef<Path>) -> Result<Vec<(u64, [f64; 3])>, ExchangeError> {
    let file = path.as_ref();
    let content = bytes(file)?;
    let source = Source { file, bytes: &content };
    if netcdf::is_one(&content) {
        return netcdf::positions(&source);
    }
    let mut positions = Vec::new();
    for (n, line) in source.lines().filter(|line| !line.text.starts_with(b"#")).enumerate() {
        if n == 0 && line.text.first().is_some_and(u8::is_ascii_alphabetic) {
            continue;
        }
        let Some([node, x, y, z]) = line.exactly() else {
            return Err(source.malformed(line.place(), line.quoted(), "node, x, y, z"));
        };
        let node = source.whole(&line, node, [0, u64::MAX], "the node")?;
        let coordinate =
            |field, axis: &str| source.number(&line, field, format_args!("{axis} of node {node}"));
        positions.push((node, [coordinate(x, "x")?, coordinate(y, "y")?, coordinate(z, "z")?]));
    }
    if positions.is_empty() { Err(source.ends("lines `node, x, y, z`")) } else { Ok(positions) }
}
