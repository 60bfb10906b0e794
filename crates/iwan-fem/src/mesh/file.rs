//! A mesh file: its bytes with its path, so that every error can name file and place; the files that it includes; and the result of reading
//! it.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use super::constraint::{Constraint, PointMass, Section};
use super::error::{MeshError, MeshWarning};
use super::topology::Mesh;

/// The contents of a mesh file.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshFile {
    /// The mesh as it is in the file; [`Structure::check`](crate::Structure::check) tells whether it can be computed.
    pub mesh: Mesh,
    /// Warnings of contents that were passed over, or read in a sense other than the file's.
    pub warnings: Vec<MeshWarning>,
    /// Constraints of the file.
    pub constraints: Vec<Constraint>,
    /// Masses at nodes.
    pub masses: Vec<PointMass>,
    /// Materials of element sets; where sets overlap, the later entry applies.
    pub sections: Vec<Section>,
}

impl MeshFile {
    /// A mesh with warnings and without constraints, masses and materials.
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
    /// Origin of the lines if the text is composed of several files; otherwise empty.
    pub(super) pieces: &'a [Piece],
}

/// Consecutive lines of one file in a text composed of several.
#[derive(Debug, Clone)]
pub(super) struct Piece {
    /// Number of its first line in the whole text, from 1.
    pub(super) first: usize,
    /// File from which it comes, and the number of that line in the file.
    pub(super) file: PathBuf,
    pub(super) line: usize,
}

impl FileBytes<'_> {
    /// Number of the line that contains the byte at `offset`, from 1.
    pub(super) fn line(&self, offset: usize) -> usize {
        self.bytes[..offset.min(self.bytes.len())].split(|b| *b == b'\n').count()
    }

    /// The description of a line for messages, from its number in the whole text.
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

/// Largest number of characters of each part of a message; longer parts are cut. Names in a file may have any length.
const LONGEST: usize = 400;

fn shown(part: impl Into<String>) -> String {
    let mut part = part.into();
    if let Some((end, _)) = part.char_indices().nth(LONGEST) {
        part.truncate(end);
        part.push_str("...");
    }
    part
}

/// Largest depth of files that include files; a longer chain counts as a circle and is refused.
const DEEPEST: usize = 16;
/// Largest number of files that one file may include in all; more are refused.
const MOST: usize = 10_000;

/// The way in which a format includes other files.
#[derive(Clone, Copy)]
pub(super) struct Include {
    /// The keyword, for messages.
    pub(super) word: &'static str,
    /// The form of such a line, for messages.
    pub(super) form: &'static str,
    pub(super) is_one: fn(&[u8]) -> bool,
    /// The name of the file in such a line.
    pub(super) input: fn(&[u8]) -> Option<PathBuf>,
}

/// The text with all included files inserted, and the origin of its pieces; the text itself if there are no includes.
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

    /// Records that the following lines come from `file`, the next one being its line number `line`.
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
