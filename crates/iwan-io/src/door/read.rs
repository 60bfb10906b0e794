//! The entry point to all formats.

use crate::assembly::{Raw, assemble};
use crate::error::ReadError;
use crate::file_bytes::{FileBytes, decode};
use crate::options::{Format, ReadOptions};
use crate::record::Record;
use crate::{lvm, mat, numpy, text, uff, wav};
use iwan_machine::shortened;
use std::path::Path;

/// Reads a record. The format is found from the content and, where the content does not decide, from the extension.
///
/// Memory: at most 64 bytes for each byte of the file. For compressed files (NPZ, MAT) the decompressed file counts,
/// whose size deflate limits to 1032 times that of the file. No count in a header is trusted for an allocation.
///
/// # Errors
/// [`ReadError`] names the file, the place in it, what stands there, what is allowed and what helps.
///
/// ```no_run
/// use iwan_io::{read, ReadOptions};
/// let options = ReadOptions {
///     time: Some("HIdata.time".into()),
///     channels: vec!["HIdata.acc1".into(), "HIdata.acc3".into()],
///     ..ReadOptions::default()
/// };
/// let record = read("hammer.mat", &options)?;
/// # Ok::<(), iwan_io::ReadError>(())
/// ```
pub fn read(path: impl AsRef<Path>, options: &ReadOptions) -> Result<Record, ReadError> {
    let file = path.as_ref();
    let bytes =
        iwan_machine::read_file(file).map_err(|source| ReadError::Io { file: file.into(), source })?;
    read_bytes(file, &bytes, options)
}

/// Reads a record from bytes in memory; `file` serves the extension and the messages only.
///
/// # Errors
/// As [`read`].
pub fn read_bytes(file: &Path, bytes: &[u8], options: &ReadOptions) -> Result<Record, ReadError> {
    let source = FileBytes { file, bytes };
    let raw = parse(source, options)?;
    assemble(&source, raw, options)
}

/// First bytes of a TDMS file. Such a file is not read; its error says how to convert it.
const TDMS_MAGIC: &[u8] = b"TDSm";

/// The format that the user gave, else that of the content, else that of the extension.
pub(super) fn format_of(source: &FileBytes, options: &ReadOptions) -> Option<Format> {
    options.format.or_else(|| by_content(source.bytes)).or_else(|| by_extension(source.file))
}

pub(super) fn parse(source: FileBytes, options: &ReadOptions) -> Result<Raw, ReadError> {
    match format_of(&source, options) {
        Some(Format::Text) => text::parse(source, options),
        Some(Format::Npy) => numpy::parse_npy(source, options),
        Some(Format::Npz) => numpy::parse_npz(source, options),
        Some(Format::Uff) => uff::parse(source, options),
        Some(Format::Mat) => mat::parse(source, options),
        Some(Format::Lvm) => lvm::parse(source, options),
        Some(Format::Wav) => wav::parse(source, options),
        None if source.bytes.starts_with(TDMS_MAGIC) => Err(ReadError::Unsupported {
            file: source.file.into(),
            place: "the file".into(),
            found: "the binary format TDMS of LabVIEW".into(),
            remedy: "write it as .lvm, CSV or .mat, in LabVIEW or by npTDMS in Python".into(),
        }),
        None => {
            let start: String = decode(&source.bytes[..source.bytes.len().min(16)]);
            let start: String = start.chars().map(|c| if c.is_control() { '.' } else { c }).collect();
            let extension = source.file.extension().unwrap_or_default().display();
            let found = format!("extension '{extension}', content '{}'", shortened(&start, 16));
            Err(ReadError::UnknownFormat { file: source.file.into(), found })
        }
    }
}

fn by_content(bytes: &[u8]) -> Option<Format> {
    if bytes.starts_with(numpy::NPY_MAGIC) {
        Some(Format::Npy)
    } else if bytes.starts_with(b"PK\x03\x04") || bytes.starts_with(b"PK\x05\x06") {
        Some(Format::Npz)
    } else if matches!(bytes.get(126..128), Some(b"IM" | b"MI")) && bytes.starts_with(b"MATLAB")
        || bytes.starts_with(b"\x89HDF")
    {
        Some(Format::Mat)
    } else if wav::is_wave(bytes) {
        Some(Format::Wav)
    } else if lvm::is_lvm(bytes) {
        Some(Format::Lvm)
    } else if opens_dataset(bytes) {
        Some(Format::Uff)
    } else {
        None
    }
}

/// Number of bytes, five lines of 80 columns, in which the first two non-empty lines of a universal file must stand to be recognised.
const LOOKED_AT: usize = 400;
/// Width in characters of the field of a dataset's number, I6; the number with the `b` of 58b fits in it.
const WIDTH: usize = 6;

/// Whether a file begins with a line `-1` behind four blanks, followed by a line that starts with a dataset number.
fn opens_dataset(bytes: &[u8]) -> bool {
    let start = &bytes[..bytes.len().min(LOOKED_AT)];
    let mut lines = start.split(|b| *b == b'\n').map(<[u8]>::trim_ascii).filter(|l| !l.is_empty());
    let number = |line: &[u8]| line.first().is_some_and(u8::is_ascii_digit);
    let word = |line: &[u8]| line.split(u8::is_ascii_whitespace).next().map_or(0, <[u8]>::len);
    start.starts_with(b"    -1")
        && lines.next() == Some(b"-1")
        && lines.next().is_some_and(|line| number(line) && word(line) <= WIDTH)
}

fn by_extension(file: &Path) -> Option<Format> {
    match file.extension()?.to_str()?.to_lowercase().as_str() {
        // A LabVIEW file without the header that `by_content` recognises is a plain table: LabVIEW omits headers on request.
        "csv" | "tsv" | "txt" | "dat" | "asc" | "lvm" => Some(Format::Text),
        "npy" => Some(Format::Npy),
        "npz" => Some(Format::Npz),
        "uff" | "unv" | "uf" | "bunv" => Some(Format::Uff),
        "mat" => Some(Format::Mat),
        "wav" | "wave" => Some(Format::Wav),
        _ => None,
    }
}
