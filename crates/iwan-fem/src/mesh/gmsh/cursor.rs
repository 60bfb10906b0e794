//! Reads the numbers of a MSH file, ASCII or binary, without ever reading past the end.

use std::fmt::Display;

use super::super::error::MeshError;
use super::super::file::{FileBytes, quote};

/// The encoding of numbers in the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Encoding {
    Ascii,
    /// Little or big endian, with the number of bytes of a `size_t`.
    Binary {
        big: bool,
        size: usize,
    },
}

/// A position in a MSH file.
pub(super) struct Cursor<'a> {
    pub(super) source: FileBytes<'a>,
    at: usize,
    encoding: Encoding,
    version: Version,
}

/// Version of the format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Version {
    /// 4.1.
    Four,
    /// 2, 2.1 and 2.2, which differ only in sections that are not needed for a mesh.
    Two,
}

const VERSION_REMEDY: &str = "save as MSH 4.1 or 2.2 (in Gmsh: -format msh41, or Mesh.MshFileVersion = 4.1)";

impl<'a> Cursor<'a> {
    /// Reads `$MeshFormat`.
    pub(super) fn open(source: FileBytes<'a>) -> Result<Self, MeshError> {
        let mut cursor = Self { source, at: 0, encoding: Encoding::Ascii, version: Version::Four };
        match cursor.section()? {
            Some((name, _)) if name == "MeshFormat" => {}
            Some((name, offset)) => {
                let found = format!("${}", quote(name.as_bytes(), 40));
                return Err(source.malformed(cursor.place_at(offset), found, "$MeshFormat"));
            }
            None => return Err(source.malformed("the whole file", "nothing", "$MeshFormat")),
        }
        let place = cursor.place();
        let version = cursor.token("the version")?;
        cursor.version = match version {
            b"4.1" => Version::Four,
            b"2" | b"2.0" | b"2.1" | b"2.2" => Version::Two,
            _ => {
                let found = format!("MSH version {}", quote(version, 16));
                return Err(source.unsupported(place, found, VERSION_REMEDY));
            }
        };
        let kind = cursor.token("the file type")?;
        let size = cursor.token("the data size")?;
        let size = match size {
            b"8" => 8,
            b"4" => 4,
            _ => return Err(source.malformed(place, format!("data size {}", quote(size, 16)), "8 or 4")),
        };
        match kind {
            b"0" => {}
            b"1" => cursor.byte_order(size)?,
            _ => return Err(source.malformed(place, format!("file type {}", quote(kind, 16)), "0 or 1")),
        }
        cursor.end_section("MeshFormat")?;
        Ok(cursor)
    }

    fn byte_order(&mut self, size: usize) -> Result<(), MeshError> {
        self.line_end();
        let place = self.place();
        let one: [u8; 4] = self.raw("the number one that tells the byte order")?;
        let big = match one {
            [1, 0, 0, 0] => false,
            [0, 0, 0, 1] => true,
            _ => {
                return Err(self.source.malformed(place, format!("{one:?}"), "the number one as four bytes"));
            }
        };
        self.encoding = Encoding::Binary { big, size };
        Ok(())
    }

    /// Moves to the start of the next line.
    fn line_end(&mut self) {
        let rest = &self.source.bytes[self.at..];
        self.at += rest.iter().position(|b| *b == b'\n').map_or(rest.len(), |n| n + 1);
    }

    pub(super) fn version(&self) -> Version {
        self.version
    }

    /// Whether the numbers of the sections are binary.
    pub(super) fn is_binary(&self) -> bool {
        self.encoding != Encoding::Ascii
    }

    /// Byte offset of the cursor.
    pub(super) fn offset(&self) -> usize {
        self.at
    }

    /// The cursor's position, for messages. It counts lines, so it is slow; use it for messages only.
    pub(super) fn place(&self) -> String {
        self.place_at(self.at)
    }

    /// The position of a byte, for messages: a line in ASCII files, a byte offset in binary ones.
    pub(super) fn place_at(&self, offset: usize) -> String {
        match self.encoding {
            Encoding::Ascii => format!("line {}", self.source.line(offset)),
            Encoding::Binary { .. } => format!("byte {offset}"),
        }
    }

    fn skip_blanks(&mut self) {
        let rest = &self.source.bytes[self.at..];
        self.at += rest.iter().position(|b| !b.is_ascii_whitespace()).unwrap_or(rest.len());
    }

    /// Name of the next section and the offset of its line; none at the end of the file.
    pub(super) fn section(&mut self) -> Result<Option<(String, usize)>, MeshError> {
        self.skip_blanks();
        let start = self.at;
        if start == self.source.bytes.len() {
            return Ok(None);
        }
        self.line_end();
        let line = self.source.bytes[start..self.at].trim_ascii_end();
        match line.strip_prefix(b"$").map(std::str::from_utf8) {
            Some(Ok(name)) if !name.starts_with("End") => Ok(Some((name.to_string(), start))),
            _ => Err(self.source.malformed(self.place_at(start), quote(line, 40), "a section ($Name)")),
        }
    }

    /// Reads the line that ends a section; anything else is an error.
    pub(super) fn end_section(&mut self, name: &str) -> Result<(), MeshError> {
        self.skip_blanks();
        let start = self.at;
        self.line_end();
        let line = self.source.bytes[start..self.at].trim_ascii_end();
        let expected = format!("$End{name}");
        if line == expected.as_bytes() {
            return Ok(());
        }
        let found = if line.is_empty() { "the end of the file".into() } else { quote(line, 40) };
        Err(self.source.malformed(self.place_at(start), found, format!("{expected} (is a count too small?)")))
    }

    /// Moves to the line after the end of a section.
    pub(super) fn skip_section(&mut self, name: &str) -> Result<(), MeshError> {
        let mark = format!("$End{name}");
        let rest = &self.source.bytes[self.at..];
        let Some(found) = rest.windows(mark.len()).position(|w| w == mark.as_bytes()) else {
            let place = self.place();
            return Err(self.source.malformed(place, "the end of the file", mark));
        };
        self.at += found;
        self.line_end();
        Ok(())
    }

    /// The rest of the present line, or at its end the next line; also for the ASCII lines of binary files.
    pub(super) fn text_line(&mut self) -> &'a [u8] {
        self.skip_blanks();
        let start = self.at;
        self.line_end();
        self.source.bytes[start..self.at].trim_ascii_end()
    }

    /// The next word; the end of the file and the end of a section are errors.
    pub(super) fn token(&mut self, what: impl Display) -> Result<&'a [u8], MeshError> {
        self.skip_blanks();
        let rest = &self.source.bytes[self.at..];
        let end = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        let word = &rest[..end];
        if word.is_empty() || word[0] == b'$' {
            let found = if word.is_empty() { "the end of the file".into() } else { quote(word, 40) };
            return Err(self.source.malformed(self.place(), found, what.to_string()));
        }
        self.at += end;
        Ok(word)
    }

    fn parsed<T: std::str::FromStr>(&mut self, what: impl Display) -> Result<T, MeshError> {
        let word = self.token(&what)?;
        let value = std::str::from_utf8(word).ok().and_then(|text| text.parse().ok());
        let place = || self.place_at(self.at - word.len());
        value.ok_or_else(|| self.source.malformed(place(), quote(word, 40), what.to_string()))
    }

    fn raw<const N: usize>(&mut self, what: impl Display) -> Result<[u8; N], MeshError> {
        match self.source.bytes.get(self.at..).and_then(|rest| rest.first_chunk::<N>()) {
            Some(bytes) => {
                self.at += N;
                Ok(*bytes)
            }
            None => Err(self.source.malformed(self.place(), "the end of the file", what.to_string())),
        }
    }

    /// An `int`.
    pub(super) fn integer(&mut self, what: impl Display) -> Result<i32, MeshError> {
        match self.encoding {
            Encoding::Ascii => self.parsed(what),
            Encoding::Binary { big: false, .. } => self.raw(what).map(i32::from_le_bytes),
            Encoding::Binary { big: true, .. } => self.raw(what).map(i32::from_be_bytes),
        }
    }

    /// A count or the number of a node or element: a `size_t`, in version 2 an `int`.
    pub(super) fn size(&mut self, what: impl Display) -> Result<u64, MeshError> {
        if self.version == Version::Two {
            return self.label(what);
        }
        match self.encoding {
            Encoding::Ascii => self.parsed(what),
            Encoding::Binary { big: false, size: 8 } => self.raw(what).map(u64::from_le_bytes),
            Encoding::Binary { big: true, size: 8 } => self.raw(what).map(u64::from_be_bytes),
            Encoding::Binary { big: false, .. } => self.raw(what).map(|b| u32::from_le_bytes(b).into()),
            Encoding::Binary { big: true, .. } => self.raw(what).map(|b| u32::from_be_bytes(b).into()),
        }
    }

    /// A `double`, which must be finite.
    pub(super) fn number(&mut self, what: impl Display) -> Result<f64, MeshError> {
        let value: f64 = match self.encoding {
            Encoding::Ascii => self.parsed(&what)?,
            Encoding::Binary { big: false, .. } => self.raw(&what).map(f64::from_le_bytes)?,
            Encoding::Binary { big: true, .. } => self.raw(&what).map(f64::from_be_bytes)?,
        };
        if value.is_finite() {
            return Ok(value);
        }
        Err(self.source.malformed(self.place(), value.to_string(), format!("{what}: a finite number")))
    }

    /// A number of a node, an element or a tag of version 2, where all are of type `int`; it must not be negative.
    fn label(&mut self, what: impl Display) -> Result<u64, MeshError> {
        let start = self.at;
        let value = self.integer(&what)?;
        u64::try_from(value).map_err(|_| {
            self.source.malformed(self.place_at(start), value.to_string(), format!("{what}: a number >= 0"))
        })
    }

    /// A count in a line of text, as in version 2, in binary files too.
    pub(super) fn text_count(&mut self, what: impl Display, words: usize) -> Result<usize, MeshError> {
        self.skip_blanks();
        let start = self.at;
        let line = self.text_line();
        let count = std::str::from_utf8(line).ok().and_then(|text| text.trim().parse::<u64>().ok());
        let count = count
            .ok_or_else(|| self.source.malformed(self.place_at(start), quote(line, 40), what.to_string()))?;
        self.fits(start, count, what, words)
    }

    /// A count of items that need at least `words` numbers each. A count for which the rest of the file has no room is an error.
    pub(super) fn count(&mut self, what: impl Display, words: usize) -> Result<usize, MeshError> {
        let start = self.at;
        let count = self.size(&what)?;
        self.fits(start, count, what, words)
    }

    /// Returns a count if the rest of the file has room for it.
    fn fits(&self, start: usize, count: u64, what: impl Display, words: usize) -> Result<usize, MeshError> {
        let least = match self.encoding {
            Encoding::Ascii => 2,
            Encoding::Binary { .. } => 4,
        };
        let most = (self.source.bytes.len() - self.at) / (least * words.max(1)) + 1;
        match usize::try_from(count) {
            Ok(count) if count <= most => Ok(count),
            _ => {
                let expected = format!("{what}: at most {most}, for which the rest of the file has room");
                Err(self.source.malformed(self.place_at(start), count.to_string(), expected))
            }
        }
    }
}
