//! Why a file of matrices could not be read: file, place, what stands there, what is allowed, what helps.

use iwan_machine::{Kind, lacking};
use std::path::PathBuf;

/// Why a file of matrices could not be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExchangeError {
    /// The operating system refused the file.
    #[error("{}: cannot be read: {source}; {}", .file.display(), lacking(source).unwrap_or("check the path and the permissions"))]
    Io {
        /// File.
        file: PathBuf,
        /// Reason given by the operating system.
        source: std::io::Error,
    },
    /// Neither extension nor content is that of a known format.
    #[error(
        "{}: unknown format ({found}); say format = \"abaqus\", \"op4\", \"dmig\", \"sierra\", \"calculix\", \"matlab\", \
         \"matrix-market\", \"npz\" or \"netcdf\"", .file.display()
    )]
    UnknownFormat {
        /// File.
        file: PathBuf,
        /// Extension and first bytes of the file, which decide its format.
        found: String,
    },
    /// The format allows this, but the reader does not support it.
    #[error("{}: {place}: {found} cannot be read; {remedy}", .file.display())]
    Unsupported {
        /// File.
        file: PathBuf,
        /// Line, byte, matrix or variable.
        place: String,
        /// What stands there.
        found: String,
        /// What helps.
        remedy: String,
    },
    /// The bytes break the rules of the format.
    #[error("{}: {place}: found {found}, expected {expected}; export the file again, or repair this place", .file.display())]
    Malformed {
        /// File.
        file: PathBuf,
        /// Line, byte, matrix or variable.
        place: String,
        /// What stands there.
        found: String,
        /// What may stand there.
        expected: String,
    },
}

impl ExchangeError {
    /// The error's kind in the catalogue of errors.
    #[must_use]
    pub fn kind(&self) -> Kind {
        match self {
            Self::Io { source, .. } if source.kind() == std::io::ErrorKind::OutOfMemory => Kind::Memory,
            Self::Io { .. } => Kind::Unreadable,
            Self::UnknownFormat { .. } => Kind::UnknownFormat,
            Self::Unsupported { .. } => Kind::Unsupported,
            Self::Malformed { .. } => Kind::Damaged,
        }
    }
}
