//! Several NumPy arrays in a zip archive, as `numpy.savez` and `numpy.savez_compressed` write them.

use super::npy;
use crate::assembly::{Chooser, Raw, clocks};
use crate::error::ReadError;
use crate::file_bytes::{FileBytes, decode};
use crate::inflate::{most, read_limited, refused};
use crate::options::ReadOptions;
use crate::warning::Warning;
use iwan_machine::{plain, shortened};
use std::collections::{BTreeMap, HashSet};
use std::io::Cursor;
use std::path::Path;
use zip::ZipArchive;

const EXPECTED: &str = "a stored or deflated NPY array";

/// Size in bytes up to which an array is read even if nobody asks for it: rates, intervals, and names for messages.
const SMALL: u64 = 1 << 20;

/// Time and channels of an NPZ file; the time is a vector `t` or `time`, or a number `dt` (seconds) or `fs` (Hz).
/// Arrays that are not numeric, such as labels, are left out with a warning.
pub(crate) fn parse(source: FileBytes, options: &ReadOptions) -> Result<Raw, ReadError> {
    let (mut variables, mut warnings, mut sparse) = (Vec::new(), Vec::new(), 0);
    each(&source, &|name, size| size <= SMALL || wanted(name, options), |name, bytes| {
        sparse += usize::from(SPARSE.contains(&name.as_str()));
        match npy::variable(&source, &bytes, &name) {
            Ok(variable) => variables.push(variable),
            Err(ReadError::Unsupported { found, .. }) if !asked(&name, options) => {
                warnings.push(Warning::LeftOut { name, reason: found });
            }
            Err(error) => return Err(error),
        }
        Ok(())
    })?;
    if sparse == SPARSE.len() && options.channels.is_empty() {
        let found = "a sparse matrix as scipy.sparse.save_npz writes it";
        return Err(source.unsupported(
            "the archive",
            found,
            "name the channels of a record in it with --channel, or save records apart from matrices",
        ));
    }
    Chooser { source, options, tabular: false }.choose(variables, warnings)
}

/// Arrays that each sparse matrix of SciPy has.
const SPARSE: [&str; 3] = ["format", "shape", "data"];

/// All arrays of an archive: the key is the name, the value the bytes of an NPY file ([`NumpyArray`](super::NumpyArray)).
///
/// # Errors
/// [`ReadError`] where the archive is damaged, two arrays have one name, or the arrays unpack to more than sensible arrays do.
pub fn numpy_members(file: &Path, bytes: &[u8]) -> Result<BTreeMap<String, Vec<u8>>, ReadError> {
    let mut members = BTreeMap::new();
    each(&FileBytes { file, bytes }, &|_, _| true, |name, bytes| {
        members.insert(name, bytes);
        Ok(())
    })?;
    Ok(members)
}

/// Whether an array of this name and of this size in bytes is wanted.
type Wanted<'a> = &'a dyn Fn(&str, u64) -> bool;

/// Passes name and bytes of each `wanted` array to `take`.
fn each(
    source: &FileBytes,
    wanted: Wanted<'_>,
    mut take: impl FnMut(String, Vec<u8>) -> Result<(), ReadError>,
) -> Result<(), ReadError> {
    let mut archive = ZipArchive::new(Cursor::new(source.bytes))
        .map_err(|e| source.malformed("zip directory", e.to_string(), "a zip archive of NPY arrays"))?;
    if let Some(name) = twice(source.bytes, archive.central_directory_start()) {
        let found = format!("two entries '{}'", shortened(&name, 60));
        return Err(source.malformed("zip directory", found, "names that differ"));
    }
    // All entries share one budget of bytes: entries of a hostile archive may share their compressed bytes.
    let mut budget = most(source.bytes.len());
    for index in 0..archive.len() {
        let Some((name, bytes)) = entry(source, &mut archive, index, (budget, wanted))? else { continue };
        budget -= bytes.len() as u64;
        take(name, bytes)?;
    }
    Ok(())
}

fn asked(name: &str, options: &ReadOptions) -> bool {
    options.channels.iter().chain(&options.time).any(|n| n == name)
}

/// Whether an array is to be read: every array where the user names no channels; else the arrays that the user names, and arrays that may
/// be their time.
fn wanted(name: &str, options: &ReadOptions) -> bool {
    let owner =
        |asked: &String| asked == name || asked.strip_prefix(name).is_some_and(|rest| rest.starts_with('['));
    options.channels.is_empty()
        || options.channels.iter().chain(&options.time).any(owner)
        || clocks::is_time_named(name)
}

/// A name that occurs twice in the directory; archive readers see only the last of such entries. `start` is the offset of the directory in
/// bytes.
fn twice(bytes: &[u8], start: u64) -> Option<String> {
    /// Signature of an entry, and its length in bytes without name, extra field and comment (APPNOTE.TXT 4.3.12).
    const ENTRY: (&[u8], usize) = (b"PK\x01\x02", 46);
    let mut rest = bytes.get(usize::try_from(start).ok()?..)?;
    let mut seen = HashSet::new();
    while rest.starts_with(ENTRY.0) {
        let length = |at: usize| rest.get(at..at + 2).map(|b| usize::from(u16::from_le_bytes([b[0], b[1]])));
        let (name, extra, comment) = (length(28)?, length(30)?, length(32)?);
        let named = rest.get(ENTRY.1..ENTRY.1 + name)?;
        if !seen.insert(named) {
            return Some(decode(named));
        }
        rest = rest.get(ENTRY.1 + name + extra + comment..)?;
    }
    None
}

/// Name and bytes of an entry `NAME.npy`; none for other files, and for arrays that are not wanted.
fn entry(
    source: &FileBytes,
    archive: &mut ZipArchive<Cursor<&[u8]>>,
    index: usize,
    (budget, wanted): (u64, Wanted<'_>),
) -> Result<Option<(String, Vec<u8>)>, ReadError> {
    let place = format!("zip entry {index} (counted from 0)");
    let bad = |e: String| source.malformed(place.clone(), e, EXPECTED);
    let mut entry = archive.by_index(index).map_err(|e| bad(e.to_string()))?;
    let name = entry.name().map_err(|e| bad(e.to_string()))?;
    let Some(name) = name.strip_suffix(".npy").map(plain) else { return Ok(None) };
    if !wanted(&name, entry.size()) {
        return Ok(None);
    }
    let budget = budget.min(most(usize::try_from(entry.compressed_size()).unwrap_or(usize::MAX)));
    let bytes = read_limited(&mut entry, budget).map_err(|e| refused(source, &place, e, EXPECTED))?;
    Ok(Some((name, bytes)))
}
