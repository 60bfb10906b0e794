//! A mesh file: its bytes with its path, so that every error can name file and place, and what a reader makes of it.

use std::path::{Path, PathBuf};

use super::constraint::{Constraint, PointMass, Section};
use super::error::{MeshError, MeshWarning};
use super::topology::Mesh;

/// A mesh file, read.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshFile {
    /// The mesh as the file has it; [`Structure::check`](crate::Structure::check) tells whether it can be computed with.
    pub mesh: Mesh,
    /// What was passed over or read in another sense than the file's.
    pub warnings: Vec<MeshWarning>,
    /// Constraints of the file.
    pub constraints: Vec<Constraint>,
    /// Masses at nodes.
    pub masses: Vec<PointMass>,
    /// Materials of element sets; where sets overlap the later entry holds.
    pub sections: Vec<Section>,
}

impl MeshFile {
    /// A mesh with warnings and nothing else.
    #[must_use]
    pub fn plain(mesh: Mesh, warnings: Vec<MeshWarning>) -> Self {
        Self { mesh, warnings, constraints: Vec::new(), masses: Vec::new(), sections: Vec::new() }
    }
}

/// A mesh file in memory, before it is read.
#[derive(Debug, Clone, Copy)]
pub(super) struct FileBytes<'a> {
    pub(super) file: &'a Path,
    pub(super) bytes: &'a [u8],
    /// Where its lines come from when it is put together of several files; empty when it is not.
    pub(super) pieces: &'a [Piece],
}

/// Lines of one file among those of several.
#[derive(Debug, Clone)]
pub(super) struct Piece {
    /// Number, from 1, of its first line in the whole text.
    pub(super) first: usize,
    /// File it comes from, and the number of that line there.
    pub(super) file: PathBuf,
    pub(super) line: usize,
}

impl FileBytes<'_> {
    /// Number, from 1, of the line that holds the byte at `offset`.
    pub(super) fn line(&self, offset: usize) -> usize {
        self.bytes[..offset.min(self.bytes.len())].split(|b| *b == b'\n').count()
    }

    /// A line for messages, by its number in the whole text.
    pub(super) fn at_line(&self, number: usize) -> String {
        match self.pieces[..self.pieces.partition_point(|piece| piece.first <= number)].last() {
            Some(piece) if piece.file != self.file => {
                format!("line {} of {}", number - piece.first + piece.line, piece.file.display())
            }
            Some(piece) => format!("line {}", number - piece.first + piece.line),
            None => format!("line {number}"),
        }
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
