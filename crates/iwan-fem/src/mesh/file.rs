//! A mesh file: its bytes with its path, so that every error can name file and place, the files that it includes, and what a reader makes of it.

use std::borrow::Cow;
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
        let (place, found, expected) = (shown(place), shown(found), shown(expected));
        MeshError::Malformed { file: self.file.into(), place, found, expected }
    }

    pub(super) fn unsupported(
        &self,
        place: impl Into<String>,
        found: impl Into<String>,
        remedy: impl Into<String>,
    ) -> MeshError {
        let (place, found, remedy) = (shown(place), shown(found), shown(remedy));
        MeshError::Unsupported { file: self.file.into(), place, found, remedy }
    }
}

/// Characters of each part of a message: names in a file may have any length, and nobody reads so many.
const LONGEST: usize = 400;

fn shown(part: impl Into<String>) -> String {
    let mut part = part.into();
    if let Some((end, _)) = part.char_indices().nth(LONGEST) {
        part.truncate(end);
        part.push_str("...");
    }
    part
}

/// Files may include files so deep: a chain longer than this is a circle.
const DEEPEST: usize = 16;
/// Files one file may include, in all.
const MOST: usize = 10_000;

/// How a format includes other files.
#[derive(Clone, Copy)]
pub(super) struct Include {
    /// Its word, for messages.
    pub(super) word: &'static str,
    /// What a line of it looks like.
    pub(super) form: &'static str,
    pub(super) is_one: fn(&[u8]) -> bool,
    /// The file that such a line names.
    pub(super) input: fn(&[u8]) -> Option<PathBuf>,
}

/// The text with all includes in their places, and where its pieces come from; the text itself where there are none.
pub(super) fn expand<'a>(
    source: FileBytes<'a>,
    folder: Option<&Path>,
    include: Include,
) -> Result<(Cow<'a, [u8]>, Vec<Piece>), MeshError> {
    if !source.bytes.split(|b| *b == b'\n').any(include.is_one) {
        return Ok((Cow::Borrowed(source.bytes), Vec::new()));
    }
    let Some(folder) = folder else {
        let remedy = "read the file from a folder, where the other can be found";
        return Err(source.unsupported("the whole file", format!("{}, another file,", include.word), remedy));
    };
    let mut out = Expanded { include, bytes: Vec::new(), pieces: Vec::new(), lines: 0, files: 0 };
    out.add(source.file, source.bytes, folder, 0)?;
    Ok((Cow::Owned(out.bytes), out.pieces))
}

struct Expanded {
    include: Include,
    bytes: Vec<u8>,
    pieces: Vec<Piece>,
    lines: usize,
    files: usize,
}

impl Expanded {
    fn add(&mut self, file: &Path, bytes: &[u8], folder: &Path, depth: usize) -> Result<(), MeshError> {
        let source = FileBytes { file, bytes, pieces: &[] };
        self.begin(file, 1);
        for (index, line) in bytes.split_inclusive(|b| *b == b'\n').enumerate() {
            if !(self.include.is_one)(line) {
                self.bytes.extend_from_slice(line);
                self.lines += usize::from(line.ends_with(b"\n"));
                continue;
            }
            let place = format!("line {}", index + 1);
            self.files += 1;
            if depth >= DEEPEST || self.files > MOST {
                let found =
                    format!("{}, {depth} files deep and the {}th in all,", self.include.word, self.files);
                return Err(source.unsupported(
                    place,
                    found,
                    "write files that do not include each other in a circle",
                ));
            }
            let path = (self.include.input)(line)
                .map(|name| folder.join(name))
                .ok_or_else(|| source.malformed(&place, quote(line.trim_ascii(), 60), self.include.form))?;
            let inner = iwan_machine::read_file(&path)
                .map_err(|source| MeshError::Io { file: path.clone(), source })?;
            self.add(&path, &inner, folder, depth + 1)?;
            if !self.bytes.ends_with(b"\n") {
                self.bytes.push(b'\n');
                self.lines += 1;
            }
            self.begin(file, index + 2);
        }
        Ok(())
    }

    /// From here on lines are those of a file, the next one being `line`.
    fn begin(&mut self, file: &Path, line: usize) {
        self.pieces.push(Piece { first: self.lines + 1, file: file.into(), line });
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
