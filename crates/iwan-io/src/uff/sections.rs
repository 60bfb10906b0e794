//! Cuts a universal file into its datasets 58 and 58b.

use crate::bytes::Order;
use crate::error::ReadError;
use crate::file_bytes::{FileBytes, decode};
use crate::warning::Warning;
use iwan_machine::shortened;

/// Columns of a line in a universal file. Some programs fill the line of the closing `-1` with blanks up to this column, and the line end
/// follows; in binary data, a longer stretch without a line end is no line.
const LINE: usize = 80;

/// Number of lines of a dataset 58 between its number and its data.
pub(super) const HEADER_LINES: usize = 11;

/// What the first line of a dataset 58b states.
#[derive(Debug, Clone, Copy)]
pub(super) struct Binary {
    pub(super) order: Order,
    /// Number of data bytes that the header promises.
    pub(super) promised: Option<u64>,
}

/// One dataset 58 or 58b.
#[derive(Debug)]
pub(super) struct Section<'a> {
    /// Number among the datasets 58 of the file, counted from 1.
    pub(super) index: usize,
    /// Byte offset of the line with the dataset number, for messages.
    pub(super) offset: usize,
    /// Byte offset behind the closing line.
    end: usize,
    pub(super) header: Vec<&'a [u8]>,
    pub(super) data: &'a [u8],
    pub(super) binary: Option<Binary>,
    /// Whether the closing `-1` is there.
    pub(super) closed: bool,
}

impl Section<'_> {
    /// The dataset's place in the file, for messages.
    pub(super) fn place(&self) -> String {
        format!("dataset 58 no. {} at byte {}", self.index, self.offset)
    }
}

/// A dataset with another number, in text.
pub(super) struct Other<'a> {
    pub(super) number: String,
    /// Byte offset of the line with the number, for messages.
    pub(super) offset: usize,
    /// Lines between the number and the closing line.
    pub(super) body: &'a [u8],
}

/// Finds all datasets 58 and 58b, and passes the other datasets to `others`.
pub(super) fn split<'a>(
    source: &FileBytes<'a>,
    warnings: &mut Vec<Warning>,
    others: &mut dyn FnMut(Other<'a>),
) -> Result<Vec<Section<'a>>, ReadError> {
    let bytes = source.bytes;
    let (mut sections, mut at, mut open) = (Vec::new(), 0, false);
    while let Some((line, next)) = line_at(bytes, at) {
        let start = at;
        at = next;
        if is_delimiter(line) {
            open = !open;
            continue;
        }
        if !std::mem::replace(&mut open, false) {
            continue;
        }
        let (number, rest) = dataset_number(line);
        if number == "58" || number == "58b" {
            let binary = (number == "58b").then(|| binary_fields(source, start, &rest)).transpose()?;
            let section = cut(source, start, next, sections.len() + 1, binary, warnings)?;
            at = section.end;
            sections.push(section);
        } else {
            let end = skip_to_delimiter(bytes, at);
            others(Other { number, offset: start, body: &bytes[at..end] });
            at = end;
            at = line_at(bytes, at).map_or(bytes.len(), |(_, next)| next);
        }
    }
    Ok(sections)
}

fn dataset_number(line: &[u8]) -> (String, Vec<String>) {
    let mut fields = line.split(u8::is_ascii_whitespace).filter(|f| !f.is_empty()).map(decode);
    let number = fields.next().unwrap_or_default().to_lowercase();
    (number, fields.collect())
}

/// Format (I6,1A1,I6,I6,I12,I12,...): byte order, floating-point format, number of ASCII lines, number of bytes.
fn binary_fields(source: &FileBytes, offset: usize, fields: &[String]) -> Result<Binary, ReadError> {
    let place = format!("first line of the dataset 58b at byte {offset}");
    let order = match fields.first().map(String::as_str) {
        Some("1") => Order::Little,
        Some("2") => Order::Big,
        other => {
            let found = format!("byte order {}", shortened(other.unwrap_or("missing"), 20));
            return Err(source.malformed(place, found, "1 (little endian) or 2 (big endian)"));
        }
    };
    match fields.get(1).map(String::as_str) {
        Some("2") => {}
        other => {
            let found = format!("floating-point format {}", shortened(other.unwrap_or("missing"), 20));
            return Err(source.unsupported(place, found, "export as IEEE 754 (format 2) or as ASCII"));
        }
    }
    Ok(Binary { order, promised: fields.get(3).and_then(|f| f.parse().ok()) })
}

/// Header lines and data of the dataset whose number stands at `start`.
fn cut<'a>(
    source: &FileBytes<'a>,
    start: usize,
    mut at: usize,
    index: usize,
    binary: Option<Binary>,
    warnings: &mut Vec<Warning>,
) -> Result<Section<'a>, ReadError> {
    let mut header = Vec::with_capacity(HEADER_LINES);
    for _ in 0..HEADER_LINES {
        let Some((line, next)) = line_at(source.bytes, at).filter(|(line, _)| !is_delimiter(line)) else {
            let place = format!("dataset 58 no. {index} at byte {start}");
            return Err(source.cut_short(place, "header lines", HEADER_LINES as u64, header.len() as u64));
        };
        header.push(line);
        at = next;
    }
    let rest = &source.bytes[at..];
    let length = match binary {
        None => skip_to_delimiter(rest, 0),
        Some(binary) => binary_length(rest, binary.promised, &header),
    };
    let (data, after) = rest.split_at(length);
    let closing = closes(after);
    let (end, closed) = (at + length + closing.unwrap_or(0), closing.is_some());
    let section = Section { index, offset: start, end, header, data, binary, closed };
    warn_of_bytes(&section, warnings);
    Ok(section)
}

fn warn_of_bytes(section: &Section, warnings: &mut Vec<Warning>) {
    let Some(promised) = section.binary.and_then(|b| b.promised) else { return };
    let found = section.data.len();
    if promised != found as u64 {
        warnings.push(Warning::Bytes { place: section.place(), promised, found });
    }
}

/// Length in bytes of binary data: the number of bytes that the number of points needs, if a `-1` line follows them; else the promised
/// number, if a `-1` line follows these (the closing line rather than the opening line of the next dataset); else up to the first `-1`
/// line; else up to the end of the file.
fn binary_length(rest: &[u8], promised: Option<u64>, header: &[&[u8]]) -> usize {
    let fields: Vec<u64> = header[6]
        .split(u8::is_ascii_whitespace)
        .filter(|f| !f.is_empty())
        .take(3)
        .map(|f| decode(f).parse().unwrap_or(0))
        .collect();
    let (kind, points) = (fields.first().copied(), fields.get(1).copied().unwrap_or(0));
    let even = fields.get(2) != Some(&0);
    let sizes: &[u64] = match (kind, even) {
        (Some(2), true) => &[4],
        (Some(2), false) | (Some(4 | 5), true) => &[8],
        (Some(4), false) => &[12, 16],
        (Some(6), true) => &[16],
        _ => &[],
    };
    let by_points = sizes.iter().filter_map(|size| points.checked_mul(*size));
    let candidates: Vec<usize> =
        by_points.chain(promised).filter_map(|n| usize::try_from(n).ok()).filter(|n| *n > 0).collect();
    let after = |n: usize| rest.get(n..).filter(|after| closes(after).is_some());
    let surely = |n: &usize| after(*n).is_some_and(|after| is_last_or_followed(without_line_end(after)));
    let strict = candidates.iter().copied().find(surely);
    let loose = || candidates.iter().copied().find(|n| after(*n).is_some());
    strict.or_else(loose).unwrap_or_else(|| first_closing(rest))
}

/// Offset of the first `-1` line in binary data, without the line end before that line.
fn first_closing(rest: &[u8]) -> usize {
    const MARK: &[u8] = b"    -1";
    let mut from = 0;
    while let Some(found) = find(&rest[from..], MARK) {
        let at = from + found;
        let ends = matches!(rest.get(at + MARK.len()), None | Some(b'\r' | b'\n' | b' '));
        if ends && is_last_or_followed(&rest[at..]) {
            let before = &rest[..at];
            let before = before.strip_suffix(b"\n").map_or(before, |b| b.strip_suffix(b"\r").unwrap_or(b));
            return before.len();
        }
        from = at + 1;
    }
    rest.len()
}

/// Whether a closing `-1` line is followed by the end of the file or by the opening `-1` line of a dataset.
fn is_last_or_followed(mark: &[u8]) -> bool {
    let Some((line, next)) = line_at(&mark[..mark.len().min(LINE + 4)], 0) else { return false };
    let mut at = next;
    if !is_delimiter(line) {
        return false;
    }
    while let Some((line, next)) = line_at(mark, at) {
        if is_delimiter(line) {
            return true;
        }
        if !line.trim_ascii().is_empty() {
            return false;
        }
        at = next;
    }
    true
}

/// Offset behind the closing `-1` line where `after` starts with this line or with a line end before it; none elsewhere.
fn closes(after: &[u8]) -> Option<usize> {
    let start = without_line_end(after);
    let (line, next) = line_at(start, 0)?;
    let short = &line[..line.len().min(LINE)];
    (is_delimiter(short) && line.len() <= LINE + 2).then_some(after.len() - start.len() + next)
}

fn without_line_end(bytes: &[u8]) -> &[u8] {
    let bytes = bytes.strip_prefix(b"\r").unwrap_or(bytes);
    bytes.strip_prefix(b"\n").unwrap_or(bytes)
}

fn skip_to_delimiter(bytes: &[u8], mut at: usize) -> usize {
    while let Some((line, next)) = line_at(bytes, at) {
        if is_delimiter(line) {
            return at;
        }
        at = next;
    }
    bytes.len()
}

/// The line at offset `at` without its line end, and the offset of the next line.
pub(super) fn line_at(bytes: &[u8], at: usize) -> Option<(&[u8], usize)> {
    let rest = bytes.get(at..).filter(|r| !r.is_empty())?;
    let end = rest.iter().position(|b| *b == b'\n').unwrap_or(rest.len());
    Some((rest[..end].strip_suffix(b"\r").unwrap_or(&rest[..end]), at + (end + 1).min(rest.len())))
}

fn is_delimiter(line: &[u8]) -> bool {
    line.trim_ascii() == b"-1"
}

fn find(haystack: &[u8], needle: &[u8]) -> Option<usize> {
    haystack.windows(needle.len()).position(|w| w == needle)
}
