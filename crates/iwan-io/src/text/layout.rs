//! How a text file is laid out: separator, decimal sign, header.

use super::clock::Clock;
use crate::assembly::units;
use crate::error::ReadError;
use crate::file_bytes::{FileBytes, decode};
use iwan_machine::{plain, shortened};
use std::borrow::Cow;

/// Number of lines in which the first row of numbers is sought. Preambles of measuring programs have up to some dozen lines. A file without
/// a row of numbers in these lines is refused as no table, before all of it is tried under every separator.
const PROBED_LINES: usize = 200;

/// What stands between columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Separator {
    Tab,
    Semicolon,
    Comma,
    /// Any run of spaces and tabs.
    Space,
}

impl Separator {
    pub(super) fn byte(self) -> u8 {
        match self {
            Self::Tab | Self::Space => b'\t',
            Self::Semicolon => b';',
            Self::Comma => b',',
        }
    }

    fn decimal_comma(self) -> bool {
        self != Self::Comma
    }

    fn split(self, line: &[u8]) -> Vec<&[u8]> {
        let mut fields: Vec<&[u8]> = match self {
            Self::Space => line.split(u8::is_ascii_whitespace).filter(|f| !f.is_empty()).collect(),
            other => line.split(|b| *b == other.byte()).map(<[u8]>::trim_ascii).collect(),
        };
        if fields.len() > 1 && fields.last().is_some_and(|f| f.is_empty()) {
            fields.pop();
        }
        fields
    }
}

/// How a text file is laid out.
#[derive(Debug)]
pub(super) struct Layout {
    pub(super) separator: Separator,
    /// Number of leading columns that hold no samples: some oscilloscopes write settings beside the first rows, and nothing beside the
    /// others.
    pub(super) settings: usize,
    /// Number of columns behind the settings.
    pub(super) fields: usize,
    /// Line of the first row of numbers, counted from 1.
    pub(super) first_row: usize,
    pub(super) names: Vec<String>,
    pub(super) units: Vec<String>,
    /// Lines skipped above the header.
    pub(super) preamble: usize,
    offset: usize,
}

/// Longest field, in characters, that is tried as a number where it does not parse as it stands: the longest decimals of an f64 that
/// programs write have some 25 characters.
const LONGEST_NUMBER: usize = 64;

struct Line<'a> {
    text: &'a [u8],
    offset: usize,
    number: usize,
}

impl Layout {
    /// Finds the separator under which a row of numbers comes first. Where several find the same line, the order is tab, semicolon, comma,
    /// space.
    pub(super) fn detect(source: &FileBytes) -> Result<Self, ReadError> {
        use Separator::{Comma, Semicolon, Space, Tab};
        let bytes = source.bytes;
        if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
            return Err(source.unsupported("byte 0", "UTF-16 text", "save it as UTF-8"));
        }
        let lines: Vec<Line> = lines(bytes).take(PROBED_LINES).collect();
        let first = |s: Separator| {
            let found = lines.iter().position(|l| !is_comment(l.text) && is_row(s, l.text, 2));
            found.map(|at| (at, s))
        };
        let several = [Tab, Semicolon, Comma, Space].into_iter().filter_map(first).min_by_key(|(at, _)| *at);
        let single = lines.iter().position(|l| !is_comment(l.text) && is_row(Comma, l.text, 1));
        let single = single.or_else(|| lines.iter().position(|l| is_row(Space, l.text, 1)));
        let separator = |at: usize| if is_row(Comma, lines[at].text, 1) { Comma } else { Space };
        match (several, single) {
            (Some((at, s)), Some(one)) if at <= one => Ok(Self::at(&lines, at, s)),
            (Some((at, s)), None) => Ok(Self::at(&lines, at, s)),
            (_, Some(one)) => Ok(Self::at(&lines, one, separator(one))),
            (None, None) => {
                let beside = |s: Separator| Self::beside_settings(&lines, s);
                [Tab, Semicolon, Comma].into_iter().find_map(beside).ok_or_else(|| no_row(source, &lines))
            }
        }
    }

    /// The layout with the first row at line `at`, or above it where an earlier row has the same fields but some of them damaged.
    fn at(lines: &[Line], at: usize, separator: Separator) -> Self {
        let fields = separator.split(lines[at].text).len();
        let damaged = |l: &Line| {
            let cells = separator.split(l.text);
            !is_comment(l.text) && cells.len() == fields && is_value(cells[0], separator)
        };
        let at = lines[..at].iter().position(damaged).unwrap_or(at);
        let above: Vec<&Line> = lines[..at].iter().filter(|l| !is_rule(l.text)).collect();
        let Header { names, units, used } = header(&above, separator, fields);
        let plain = above.iter().filter(|l| !is_comment(l.text)).count();
        let (first_row, offset) = (lines[at].number, lines[at].offset);
        let preamble = plain.saturating_sub(used);
        Self { separator, settings: 0, fields, first_row, names, units, preamble, offset }
    }

    /// The layout of columns beside settings. In some row empty cells stand in front of two or more numbers; from the first row on, the
    /// columns of these numbers hold numbers.
    fn beside_settings(lines: &[Line], separator: Separator) -> Option<Self> {
        let count = |l: &Line| separator.split(l.text).len();
        let tail = |l: &Line, settings: usize| {
            let cells = separator.split(l.text);
            cells.len() >= settings + 2 && cells[settings..].iter().all(|f| number(f, separator).is_some())
        };
        let empty = |l: &Line| separator.split(l.text).iter().take_while(|f| f.is_empty()).count();
        let row = lines.iter().find(|l| empty(l) > 0 && tail(l, empty(l)))?;
        let settings = empty(row);
        let first = lines.iter().find(|l| count(l) == count(row) && tail(l, settings))?;
        let above = lines.iter().take_while(|l| l.number < first.number);
        Some(Self {
            separator,
            settings,
            fields: count(row) - settings,
            first_row: first.number,
            names: Vec::new(),
            units: Vec::new(),
            preamble: above.filter(|l| !l.text.trim_ascii().is_empty()).count(),
            offset: first.offset,
        })
    }

    /// The rows, with runs of white space turned into tabs where white space separates.
    pub(super) fn body<'a>(&self, bytes: &'a [u8]) -> Cow<'a, [u8]> {
        let body = &bytes[self.offset..];
        if self.separator != Separator::Space {
            return Cow::Borrowed(body);
        }
        let mut out = Vec::with_capacity(body.len() + 1);
        for line in body.split(|b| *b == b'\n') {
            for (i, field) in self.separator.split(line).into_iter().enumerate() {
                if i > 0 {
                    out.push(b'\t');
                }
                out.extend_from_slice(field);
            }
            out.push(b'\n');
        }
        Cow::Owned(out)
    }

    /// Number of fields in a row, settings included.
    pub(super) fn all(&self) -> usize {
        self.settings + self.fields
    }

    /// Number of fields in a row, an empty field at the end not counted; 0 in an empty line.
    pub(super) fn count(&self, record: &csv::ByteRecord) -> usize {
        let n = record.len();
        let empty = |i: usize| record[i].trim_ascii().is_empty();
        match n {
            0 => 0,
            1 if empty(0) => 0,
            n if n == self.all() + 1 && empty(n - 1) => n - 1,
            n => n,
        }
    }

    pub(super) fn number(&self, field: &[u8]) -> Option<f64> {
        number(field, self.separator)
    }

    pub(super) fn clock(&self, field: &[u8]) -> Option<Clock> {
        clock(field, self.separator)
    }
}

/// What the lines just above the rows hold.
#[derive(Default)]
struct Header {
    names: Vec<String>,
    units: Vec<String>,
    /// Number of uncommented lines that hold these names and units.
    used: usize,
}

fn header(above: &[&Line], separator: Separator, fields: usize) -> Header {
    let cells = |l: &Line| -> Option<Vec<String>> {
        let text = l.text.trim_ascii();
        let text = if is_comment(text) { text[1..].trim_ascii() } else { text };
        let cells: Vec<String> = split_quoted(separator, text);
        (cells.len() == fields).then_some(cells)
    };
    let words = |row: &[String]| row.iter().all(|c| !c.is_empty() && !is_value(c.as_bytes(), separator));
    let Some((last, rest)) = above.split_last() else { return Header::default() };
    let Some(lower) = cells(last) else { return Header::default() };
    let plain = |l: &Line| usize::from(!is_comment(l.text));
    if let Some(line) = rest.last().filter(|l| words(&lower) && plain(l) == plain(last)) {
        let known = lower.iter().any(|u| units::is_unit(u));
        if let Some(upper) = cells(line).filter(|row| known && words(row)) {
            return Header { names: upper, units: lower, used: plain(line) + plain(last) };
        }
    }
    Header { names: lower, units: Vec::new(), used: plain(last) }
}

fn split_quoted(separator: Separator, text: &[u8]) -> Vec<String> {
    if separator == Separator::Space {
        return separator.split(text).into_iter().map(|c| plain(&decode(c))).collect();
    }
    let mut reader =
        csv::ReaderBuilder::new().has_headers(false).delimiter(separator.byte()).from_reader(text);
    let mut record = csv::ByteRecord::new();
    let read = reader.read_byte_record(&mut record).unwrap_or(false);
    let mut cells: Vec<String> = record.iter().map(|c| plain(&decode(c.trim_ascii()))).collect();
    if cells.len() > 1 && cells.last().is_some_and(String::is_empty) {
        cells.pop();
    }
    if read { cells } else { Vec::new() }
}

/// Whether a line is a comment.
pub(super) fn is_comment(line: &[u8]) -> bool {
    matches!(line.trim_ascii_start().first(), Some(b'#' | b'%'))
}

fn is_row(separator: Separator, line: &[u8], least: usize) -> bool {
    let fields = separator.split(line);
    let is_number = |f: &&[u8]| number(f, separator).is_some();
    // A line that holds times of day only is the date of a file, not a row.
    fields.len() >= least && fields.iter().any(is_number) && fields.iter().all(|f| is_value(f, separator))
}

/// Whether a line is empty, or a rule of strokes between a header and its rows.
fn is_rule(line: &[u8]) -> bool {
    line.iter().all(|b| b.is_ascii_whitespace() || b"-=_|+,;".contains(b))
}

/// Whether a cell holds a number or a time of day.
fn is_value(field: &[u8], separator: Separator) -> bool {
    number(field, separator).is_some() || clock(field, separator).is_some()
}

fn clock(field: &[u8], separator: Separator) -> Option<Clock> {
    let text = std::str::from_utf8(field).ok()?.trim().trim_matches('"').trim();
    if separator.decimal_comma() { Clock::in_cell(&text.replace(',', ".")) } else { Clock::in_cell(text) }
}

/// Whether a cell is empty, or holds the `NA` that R writes where nothing was measured.
pub(super) fn is_blank(field: &[u8]) -> bool {
    let quoted = |b: &u8| *b == b'"' || b.is_ascii_whitespace();
    let mut left = field.iter().filter(|b| !quoted(b));
    matches!((left.next(), left.next(), left.next()), (None, ..) | (Some(b'N'), Some(b'A'), None))
}

fn number(field: &[u8], separator: Separator) -> Option<f64> {
    let text = std::str::from_utf8(field).ok()?.trim().trim_matches('"').trim();
    if let Ok(value) = text.parse() {
        return Some(value);
    }
    if text.len() > LONGEST_NUMBER {
        return None;
    }
    let comma = separator.decimal_comma() && text.bytes().filter(|b| *b == b',').count() == 1;
    let text = if comma { text.replace(',', ".") } else { text.into() };
    text.replace(['d', 'D'], "e").parse().ok() // Fortran writes 1.0D+00
}

fn lines(bytes: &[u8]) -> impl Iterator<Item = Line<'_>> {
    let start = if bytes.starts_with(&[0xef, 0xbb, 0xbf]) { 3 } else { 0 };
    let mut offset = start;
    bytes[start..].split(|b| *b == b'\n').enumerate().map(move |(i, text)| {
        let line = Line { text, offset, number: i + 1 };
        offset += text.len() + 1;
        line
    })
}

fn no_row(source: &FileBytes, lines: &[Line]) -> ReadError {
    let first = lines.iter().find(|l| !l.text.trim_ascii().is_empty());
    let found = first.map_or("an empty file".into(), |l| {
        let text: String = decode(l.text.trim_ascii()).chars().filter(|c| !c.is_control()).collect();
        format!("'{}' and no row of numbers in the first {} lines", shortened(&text, 40), lines.len())
    });
    let place = format!("line {}", first.map_or(1, |l| l.number));
    source.malformed(place, found, "rows of numbers between comma, semicolon, tab or white space")
}
