//! Lines of an input file, without comments and blank lines.

use super::super::file::{FileBytes, quote};

/// One line.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line<'a> {
    /// Number of the line, counted from 1.
    pub(super) number: usize,
    /// Byte offset at which the line begins.
    pub(super) offset: usize,
    /// Text without blanks at the two ends.
    pub(super) text: &'a [u8],
}

impl<'a> Line<'a> {
    /// Place of the line in the file, for messages.
    pub(super) fn place(&self, source: FileBytes) -> String {
        source.at_line(self.number)
    }

    pub(super) fn is_keyword(&self) -> bool {
        self.text.starts_with(b"*")
    }

    /// Text of the line as messages quote it.
    pub(super) fn quoted(&self) -> String {
        quote(self.text, 60)
    }

    /// Whether the line ends in a comma, so that the next line continues it.
    pub(super) fn continues(&self) -> bool {
        self.text.ends_with(b",")
    }

    /// Fields between the commas; a comma at the end of the line begins no field.
    pub(super) fn fields(&self) -> impl Iterator<Item = &'a [u8]> + use<'a> {
        let text = self.text.strip_suffix(b",").unwrap_or(self.text);
        text.split(|b| *b == b',').map(<[u8]>::trim_ascii)
    }
}

/// Iterates over the lines of a file.
pub(super) struct Lines<'a> {
    pub(super) source: FileBytes<'a>,
    at: usize,
    number: usize,
}

impl<'a> Lines<'a> {
    pub(super) fn new(source: FileBytes<'a>) -> Self {
        let at = if source.bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
        Self { source, at, number: 0 }
    }

    /// The next line that is neither blank nor a comment (`**`).
    pub(super) fn next(&mut self) -> Option<Line<'a>> {
        loop {
            let offset = self.at;
            let rest = self.source.bytes.get(offset..).filter(|rest| !rest.is_empty())?;
            let end = rest.iter().position(|b| *b == b'\n').unwrap_or(rest.len());
            self.at = offset + (end + 1).min(rest.len());
            self.number += 1;
            let text = rest[..end].trim_ascii();
            if !text.is_empty() && !text.starts_with(b"**") {
                return Some(Line { number: self.number, offset, text });
            }
        }
    }

    /// The next line if it is a line of data; a keyword line stays unread.
    pub(super) fn next_data(&mut self) -> Option<Line<'a>> {
        let (at, number) = (self.at, self.number);
        match self.next() {
            Some(line) if !line.is_keyword() => Some(line),
            _ => {
                (self.at, self.number) = (at, number);
                None
            }
        }
    }
}
