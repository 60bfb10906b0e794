//! `*INCLUDE`: the lines of other files in place of it, each piece with its own name and line numbers.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use super::super::error::MeshError;
use super::super::file::{FileBytes, Piece, quote};
use super::keyword::label;

/// Files may include files so deep: a chain longer than this is a circle.
const DEEPEST: usize = 16;
/// Files one file may include, in all.
const MOST: usize = 10_000;

/// The text with all includes in their places, and where its pieces come from; the text itself where there are none.
pub(super) fn expand<'a>(
    source: FileBytes<'a>,
    folder: Option<&Path>,
) -> Result<(Cow<'a, [u8]>, Vec<Piece>), MeshError> {
    if !source.bytes.split(|b| *b == b'\n').any(is_include) {
        return Ok((Cow::Borrowed(source.bytes), Vec::new()));
    }
    let Some(folder) = folder else {
        let remedy = "read the file from a folder, where the other can be found";
        return Err(source.unsupported("the whole file", "*INCLUDE, another file,", remedy));
    };
    let mut out = Expanded::default();
    out.add(source.file, source.bytes, folder, 0)?;
    Ok((Cow::Owned(out.bytes), out.pieces))
}

#[derive(Default)]
struct Expanded {
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
            if !is_include(line) {
                self.bytes.extend_from_slice(line);
                self.lines += usize::from(line.ends_with(b"\n"));
                continue;
            }
            let place = format!("line {}", index + 1);
            self.files += 1;
            if depth >= DEEPEST || self.files > MOST {
                let found = format!("*INCLUDE, {depth} files deep and the {}th in all,", self.files);
                return Err(source.unsupported(
                    place,
                    found,
                    "write files that do not include each other in a circle",
                ));
            }
            let path = input(line).map(|name| folder.join(name)).ok_or_else(|| {
                source.malformed(&place, quote(line.trim_ascii(), 60), "*INCLUDE, INPUT=FILE on one line")
            })?;
            let inner =
                std::fs::read(&path).map_err(|source| MeshError::Io { file: path.clone(), source })?;
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

fn is_include(line: &[u8]) -> bool {
    let line = line.trim_ascii();
    let word = line.strip_prefix(b"*").map(<[u8]>::trim_ascii_start).unwrap_or_default();
    word.get(..7).is_some_and(|word| word.eq_ignore_ascii_case(b"INCLUDE"))
        && word.get(7).is_none_or(|next| *next == b',' || next.is_ascii_whitespace())
}

/// Value of INPUT.
fn input(line: &[u8]) -> Option<PathBuf> {
    line.split(|b| *b == b',').find_map(|field| {
        let at = field.iter().position(|b| *b == b'=')?;
        field[..at]
            .trim_ascii()
            .eq_ignore_ascii_case(b"INPUT")
            .then(|| PathBuf::from(label(&field[at + 1..])))
    })
}
