//! A mesh file: its bytes with its path, so that every error can name file and place, and what a reader makes of it.

use std::path::Path;

use super::error::{MeshError, MeshWarning};
use super::topology::Mesh;

/// A mesh file, read.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshFile {
    /// The mesh as the file has it; [`Structure::check`](crate::Structure::check) tells whether it can be computed with.
    pub mesh: Mesh,
    /// What was passed over or read in another sense than the file's.
    pub warnings: Vec<MeshWarning>,
}

/// A mesh file in memory, before it is read.
#[derive(Debug, Clone, Copy)]
pub(super) struct FileBytes<'a> {
    pub(super) file: &'a Path,
    pub(super) bytes: &'a [u8],
}

impl FileBytes<'_> {
    /// Number, from 1, of the line that holds the byte at `offset`.
    pub(super) fn line(&self, offset: usize) -> usize {
        self.bytes[..offset.min(self.bytes.len())].split(|b| *b == b'\n').count()
    }

    pub(super) fn malformed(
        &self,
        place: impl Into<String>,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> MeshError {
        let (place, found, expected) = (place.into(), found.into(), expected.into());
        MeshError::Malformed { file: self.file.into(), place, found, expected }
    }

    pub(super) fn unsupported(
        &self,
        place: impl Into<String>,
        found: impl Into<String>,
        remedy: impl Into<String>,
    ) -> MeshError {
        let (place, found, remedy) = (place.into(), found.into(), remedy.into());
        MeshError::Unsupported { file: self.file.into(), place, found, remedy }
    }
}

/// A piece of the file for a message: readable, at most `limit` characters, in quotes.
pub(super) fn quote(bytes: &[u8], limit: usize) -> String {
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(4 * limit)]);
    let mut short: String = text.chars().take(limit).map(|c| if c.is_control() { '.' } else { c }).collect();
    if text.chars().count() > limit || bytes.len() > 4 * limit {
        short.push_str("...");
    }
    format!("'{short}'")
}
