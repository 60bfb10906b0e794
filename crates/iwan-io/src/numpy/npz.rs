//! Several NumPy arrays in a zip archive, as `numpy.savez` and `numpy.savez_compressed` write them.

use super::npy;
use crate::assembly::{Chooser, Raw};
use crate::error::ReadError;
use crate::file_bytes::FileBytes;
use crate::inflate::{most, read_limited};
use crate::options::ReadOptions;
use crate::warning::Warning;
use std::io::Cursor;
use zip::ZipArchive;

/// Time and channels of an NPZ file; the time is a vector `t` or `time`, or a number `dt` (seconds) or `fs` (Hz).
/// Arrays that are not numeric (labels, say) are left out with a warning.
pub(crate) fn parse(source: FileBytes, options: &ReadOptions) -> Result<Raw, ReadError> {
    let mut archive = ZipArchive::new(Cursor::new(source.bytes))
        .map_err(|e| source.malformed("zip directory", e.to_string(), "a zip archive of NPY arrays"))?;
    let (mut variables, mut warnings) = (Vec::new(), Vec::new());
    // One budget for all entries: those of a hostile archive may share their compressed bytes.
    let mut budget = most(source.bytes.len());
    for index in 0..archive.len() {
        let Some((name, bytes)) = entry(&source, &mut archive, index, budget)? else { continue };
        budget -= bytes.len() as u64;
        match npy::array(&source, &bytes, &name) {
            Ok(variable) => variables.push(variable),
            Err(ReadError::Unsupported { found, .. }) if !asked(&name, options) => {
                warnings.push(Warning::LeftOut { name, reason: found });
            }
            Err(error) => return Err(error),
        }
    }
    Chooser { source, options, tabular: false }.choose(variables, warnings)
}

fn asked(name: &str, options: &ReadOptions) -> bool {
    options.channels.iter().chain(&options.time).any(|n| n == name)
}

/// Name and bytes of an entry `NAME.npy`; none for another file.
fn entry(
    source: &FileBytes,
    archive: &mut ZipArchive<Cursor<&[u8]>>,
    index: usize,
    budget: u64,
) -> Result<Option<(String, Vec<u8>)>, ReadError> {
    let place = format!("zip entry {index} (counted from 0)");
    let bad = |e: String| source.malformed(place.clone(), e, "a stored or deflated NPY array");
    let mut entry = archive.by_index(index).map_err(|e| bad(e.to_string()))?;
    let name = entry.name().map_err(|e| bad(e.to_string()))?;
    let Some(name) = name.strip_suffix(".npy").map(str::to_string) else { return Ok(None) };
    let bytes = read_limited(&mut entry, budget).map_err(|e| bad(e.to_string()))?;
    Ok(Some((name, bytes)))
}
