//! Writes dense arrays of numbers to an NPZ archive, and reads them again with the same bits.

use std::collections::BTreeMap;
use std::io::{self, Cursor, Write};
use std::path::Path;

use zip::write::SimpleFileOptions;

use crate::error::ExchangeError;
use crate::packed::npy::array;
use crate::packed::npz::members;
use crate::source::Source;

/// Number of values above which a member is written with 64-bit sizes: 2 GiB, half of what 32-bit sizes can express, so that its header has
/// room.
const ZIP32: usize = 1 << 28;
/// Number of values that are turned into bytes at once, 32 KiB, so that no second copy of an array is made.
const CHUNK: usize = 1 << 12;

/// An array to be written; values are in rows, one row after the other.
#[derive(Debug, Clone, Copy)]
pub struct ArrayRef<'a> {
    /// The array's name in the archive.
    pub name: &'a str,
    /// Size of each dimension; the product of the sizes is the number of values.
    pub shape: &'a [usize],
    /// Values.
    pub values: &'a [f64],
}

/// An array that was read; values are in rows, one row after the other.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredArray {
    /// Size of each dimension.
    pub shape: Vec<usize>,
    /// Values.
    pub values: Vec<f64>,
}

/// Writes arrays as `numpy.savez` does, float64, not compressed, for `numpy.load` and [`read_arrays`].
///
/// # Errors
/// What the sink reports.
///
/// ```
/// use iwan_exchange::{ArrayRef, arrays_to_npz, read_arrays};
/// let file = std::env::temp_dir().join(format!("iwan-doc-arrays-{}.npz", std::process::id()));
/// let written = ArrayRef { name: "shapes", shape: &[2, 2], values: &[0.1, 0.2, 0.3, f64::MIN_POSITIVE] };
/// arrays_to_npz(std::fs::File::create(&file)?, &[written])?;
/// let read = read_arrays(&file)?;
/// std::fs::remove_file(&file)?;
/// assert_eq!((&read["shapes"].shape[..], &read["shapes"].values[..]), (written.shape, written.values));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn arrays_to_npz(sink: impl Write + io::Seek, arrays: &[ArrayRef<'_>]) -> io::Result<()> {
    let mut archive = zip::ZipWriter::new(sink);
    for array in arrays {
        start(&mut archive, array.name, "<f8", array.shape, array.values.len() > ZIP32)?;
        for chunk in array.values.chunks(CHUNK) {
            archive.write_all(&chunk.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>())?;
        }
    }
    archive.finish()?;
    Ok(())
}

/// Begins a member of an archive with its NPY header of format version 1 (`numpy.lib.format`).
pub(super) fn start<W: Write + io::Seek>(
    archive: &mut zip::ZipWriter<W>,
    name: &str,
    descr: &str,
    shape: &[usize],
    large: bool,
) -> io::Result<()> {
    let stored = SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
    archive.start_file(format!("{name}.npy"), stored.large_file(large))?;
    let sizes: Vec<String> = shape.iter().map(|size| format!("{size}, ")).collect();
    let sizes = sizes.concat();
    let mut text = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': ({sizes}), }}");
    // Magic string, version and length take ten bytes; the data begin at a multiple of 64 bytes.
    let length = (10 + text.len() + 1).next_multiple_of(64) - 10;
    text.push_str(&" ".repeat(length - 1 - text.len()));
    text.push('\n');
    let too_long = || io::Error::other("a header of more than 65 kB");
    archive.write_all(iwan_io::NPY_MAGIC)?;
    archive.write_all(&[1, 0])?;
    archive.write_all(&u16::try_from(length).map_err(|_| too_long())?.to_le_bytes())?;
    archive.write_all(text.as_bytes())
}

/// Reads all arrays of an NPZ archive, whose numbers must be finite.
///
/// # Errors
/// [`ExchangeError`] names the file, the array, what stands there and what is allowed.
pub fn read_arrays(path: impl AsRef<Path>) -> Result<BTreeMap<String, StoredArray>, ExchangeError> {
    let file = path.as_ref();
    let bytes =
        iwan_machine::read_file(file).map_err(|source| ExchangeError::Io { file: file.into(), source })?;
    let source = Source { file, bytes: &bytes };
    let mut out = BTreeMap::new();
    for (name, bytes) in members(&source)? {
        let array = array(&source, &bytes, &name)?;
        let place = || format!("array '{name}'");
        if array.letters().is_some() || array.fortran {
            let found = "text, or columns one after the other,";
            return Err(source.unsupported(place(), found, "save numbers, rows one after the other"));
        }
        let mut values = Vec::with_capacity(array.len());
        for at in 0..array.len() {
            let value = array.at(at).unwrap_or(f64::NAN);
            if !value.is_finite() {
                let found = format!("{value} at entry {}", at + 1);
                return Err(source.malformed(place(), found, "finite numbers"));
            }
            values.push(value);
        }
        out.insert(name.clone(), StoredArray { shape: array.shape.clone(), values });
    }
    Ok(out)
}

/// The bytes of an archive that `fill` writes in memory.
pub(super) fn in_memory(
    fill: impl FnOnce(&mut zip::ZipWriter<Cursor<Vec<u8>>>) -> io::Result<()>,
) -> io::Result<Vec<u8>> {
    let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
    fill(&mut archive)?;
    Ok(archive.finish()?.into_inner())
}
