//! The entries of an NPZ archive.

use std::io::{self, Seek, Write};

use zip::ZipWriter;
use zip::write::SimpleFileOptions;

/// Number of values above which an entry is written with 64-bit sizes: 2 GiB, half of what 32-bit sizes can express, so that the header of
/// the array has room.
const ZIP32: usize = 1 << 28;

/// Begins an uncompressed entry for a one-dimensional float64 array; its values are to follow.
pub(super) fn entry<W: Write + Seek>(archive: &mut ZipWriter<W>, name: &str, rows: usize) -> io::Result<()> {
    let stored = SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
    archive.start_file(format!("{name}.npy"), stored.large_file(rows > ZIP32))?;
    archive.write_all(&npy_header(rows))
}

/// The bytes of values as an NPY array stores them: little endian, 8 bytes each.
pub(super) fn bytes(values: &[f64]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

/// Header of a one-dimensional float64 array, version 1, padded so that the data start at a multiple of 64 bytes.
fn npy_header(rows: usize) -> Vec<u8> {
    let mut text = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({rows},), }}");
    let length = (10 + text.len() + 1).next_multiple_of(64) - 10;
    text.push_str(&" ".repeat(length - 1 - text.len()));
    text.push('\n');
    let mut header = crate::numpy::NPY_MAGIC.to_vec();
    header.extend([1, 0]);
    header.extend(u16::try_from(length).unwrap_or(118).to_le_bytes());
    header.extend(text.bytes());
    header
}
