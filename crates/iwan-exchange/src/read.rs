//! The entry point to all formats.

use std::path::Path;

use crate::error::ExchangeError;
use crate::matrix::Matrix;
use crate::nastran::{dmig, op4_binary, op4_text};
use crate::packed::{mat, netcdf, npy, npz};
use crate::source::{Source, quote};
use crate::text::{abaqus, calculix, matrix_market, sierra};

/// A format of files of matrices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Format {
    /// Abaqus `.mtx`: MATRIX INPUT, COORDINATE or the user element of a substructure.
    Abaqus,
    /// Nastran OP4, text or binary.
    Op4,
    /// Nastran DMIG in bulk data or punch files.
    Dmig,
    /// Sierra/SD `Kaa.m`.
    Sierra,
    /// CalculiX `.sti` and `.mas`.
    Calculix,
    /// MATLAB level 5 (`-v6`, `-v7`) and 7.3.
    Matlab,
    /// Matrix Market.
    MatrixMarket,
    /// `scipy.sparse.save_npz`, or a dense NumPy array.
    Npz,
    /// netCDF classic: a Craig-Bampton model of Sierra/SD.
    Netcdf,
}

impl Format {
    /// All formats with the words that name them.
    pub const ALL: &'static [(&'static str, Self)] = &[
        ("abaqus", Self::Abaqus),
        ("op4", Self::Op4),
        ("dmig", Self::Dmig),
        ("sierra", Self::Sierra),
        ("calculix", Self::Calculix),
        ("matlab", Self::Matlab),
        ("matrix-market", Self::MatrixMarket),
        ("npz", Self::Npz),
        ("netcdf", Self::Netcdf),
    ];

    /// The format of a file by its content and, where the content does not decide, by its extension.
    fn of(file: &Path, bytes: &[u8]) -> Option<Self> {
        let extension = file.extension().unwrap_or_default().to_ascii_lowercase();
        if bytes.len() >= 14 && bytes[..14].eq_ignore_ascii_case(b"%%MatrixMarket") {
            return Some(Self::MatrixMarket);
        }
        if bytes.starts_with(b"PK\x03\x04") || bytes.starts_with(iwan_io::NPY_MAGIC) {
            return Some(Self::Npz);
        }
        if netcdf::is_one(bytes) {
            return Some(Self::Netcdf);
        }
        match extension.to_str()? {
            "mtx" => Some(Self::Abaqus),
            "op4" => Some(Self::Op4),
            "pch" | "bdf" | "dat" | "nas" | "bulk" => Some(Self::Dmig),
            "m" => Some(Self::Sierra),
            "sti" | "mas" | "dam" => Some(Self::Calculix),
            "mat" => Some(Self::Matlab),
            _ => None,
        }
    }
}

/// Reads all matrices of a file. If `format` is none, the format is found from the content and the extension.
///
/// Memory: at most 64 bytes for each byte of the file (after decompression, where it is compressed), and 64 KiB. No count in a file is
/// trusted for an allocation.
///
/// # Errors
/// [`ExchangeError`] names the file, the place in it, what stands there, what is allowed and what helps.
pub fn read(path: impl AsRef<Path>, format: Option<Format>) -> Result<Vec<Matrix>, ExchangeError> {
    let file = path.as_ref();
    let bytes =
        iwan_machine::read_file(file).map_err(|source| ExchangeError::Io { file: file.into(), source })?;
    read_bytes(file, &bytes, format)
}

/// Reads all matrices from bytes in memory; `file` serves the extension and the messages only.
///
/// # Errors
/// As [`read`].
///
/// ```
/// use iwan_exchange::{Stored, read_bytes};
/// let text = b"%%MatrixMarket matrix coordinate real symmetric\n2 2 3\n1 1 2.0\n2 1 -1.0\n2 2 2.0\n";
/// let matrices = read_bytes("k.mtx".as_ref(), text, None)?;
/// assert_eq!((matrices[0].rows, matrices[0].stored), (2, Stored::Triangle));
/// assert_eq!(matrices[0].entries[1], (1, 0, -1.0));
/// # Ok::<(), iwan_exchange::ExchangeError>(())
/// ```
pub fn read_bytes(file: &Path, bytes: &[u8], format: Option<Format>) -> Result<Vec<Matrix>, ExchangeError> {
    let source = Source { file, bytes };
    if bytes.iter().all(u8::is_ascii_whitespace) {
        return Err(source.malformed("the whole file", "nothing", "a matrix"));
    }
    let Some(format) = format.or_else(|| Format::of(file, bytes)) else {
        let extension = file.extension().unwrap_or_default();
        let found = format!("extension '{}', content {}", extension.display(), quote(bytes, 16));
        return Err(ExchangeError::UnknownFormat { file: file.into(), found });
    };
    match format {
        Format::Abaqus => abaqus::parse(&source),
        Format::Op4 if is_text(bytes) => op4_text::parse(&source),
        Format::Op4 => op4_binary::parse(&source),
        Format::Dmig => dmig::parse(&source),
        Format::Sierra => sierra::parse(&source),
        Format::Calculix => calculix::parse(&source),
        Format::Matlab => mat::parse(&source),
        Format::MatrixMarket => matrix_market::parse(&source),
        Format::Npz if bytes.starts_with(iwan_io::NPY_MAGIC) => npy::parse(&source),
        Format::Npz => npz::parse(&source),
        Format::Netcdf if netcdf::is_one(bytes) => netcdf::parse(&source),
        Format::Netcdf => {
            let found = quote(&bytes[..bytes.len().min(8)], 8);
            Err(source.malformed("the header", found, "CDF and version 1, 2 or 5: netCDF classic"))
        }
    }
}

/// Whether an OP4 file is text: the first 24 bytes, which hold numbers and a name, are then characters.
fn is_text(bytes: &[u8]) -> bool {
    let start = bytes.get(..24).unwrap_or(bytes);
    start.iter().all(|b| matches!(b, b' '..=b'~' | b'\n' | b'\r'))
}
