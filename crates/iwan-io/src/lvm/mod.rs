//! Measurement files of LabVIEW (`.lvm`): text with one header for the file and one header for each segment of data.
//!
//! Layout after "Specification for the LabVIEW Measurement File (.lvm)", National Instruments. Fields are separated by tabs, commas or what
//! the header states; the decimal sign may be a comma; there is one column of X, one for each channel, or none. Segments with the same
//! channels that follow each other evenly become one record; other segments are refused with the reason.

mod segment;

use crate::assembly::Raw;
use crate::error::ReadError;
use crate::file_bytes::{FileBytes, decode};
use crate::options::ReadOptions;
use iwan_machine::{plain, shortened};
use segment::{Interval, Segment};

/// First words of the file.
const MAGIC: &[u8] = b"LabVIEW Measurement";
/// Last line of a header.
const END: &str = "***End_of_Header***";
/// Largest number of channels, equal to that of columns in other text files. A file that states more is damaged, and refused.
const MOST_CHANNELS: usize = 10_000;

/// Whether bytes begin as a LabVIEW measurement file does.
pub(crate) fn is_lvm(bytes: &[u8]) -> bool {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).starts_with(MAGIC)
}

/// What the header of the file says about its layout.
struct Style {
    separator: char,
    decimal_comma: bool,
    x_columns: XColumns,
}

/// How many columns of X there are: none, one, or one for each channel.
#[derive(Clone, Copy, PartialEq, Eq)]
enum XColumns {
    None,
    One,
    Multi,
}

/// The lines of the file with their numbers, counted from 0 here and from 1 in messages.
struct Lines<'a> {
    source: &'a FileBytes<'a>,
    rest: std::iter::Peekable<std::iter::Enumerate<std::str::Lines<'a>>>,
}

/// Time and channels of the file.
pub(crate) fn parse(source: FileBytes, options: &ReadOptions) -> Result<Raw, ReadError> {
    let text = decode(source.bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(source.bytes));
    let mut lines = Lines { source: &source, rest: text.lines().enumerate().peekable() };
    let style = lines.style()?;
    let mut whole: Option<Segment> = None;
    while let Some(segment) = lines.segment(&style)? {
        match &mut whole {
            None => whole = Some(segment),
            Some(whole) => whole.append(segment).map_err(|found| {
                let remedy = "save one segment to a file, or export the part that is meant";
                source.unsupported("segments", found, remedy)
            })?,
        }
    }
    let whole = whole
        .ok_or_else(|| source.malformed("the end", "no segment with numbers", "a segment header and rows"))?;
    whole.into_raw(&source, options)
}

impl Lines<'_> {
    fn place(number: usize) -> String {
        format!("line {}", number + 1)
    }

    /// The header of the file.
    fn style(&mut self) -> Result<Style, ReadError> {
        let mut style = Style { separator: '\t', decimal_comma: false, x_columns: XColumns::One };
        let first = self.rest.peek().map_or("", |(_, line)| line);
        // The separator stands behind the first words of the file, before the header names it.
        if let Some(separator) = first.chars().nth(MAGIC.len()).filter(|c| matches!(c, '\t' | ',' | ';')) {
            style.separator = separator;
        }
        for (number, line) in self.rest.by_ref() {
            if line.trim().starts_with(END) {
                return Ok(style);
            }
            let mut cells = line.split(style.separator).map(str::trim);
            match (cells.next().unwrap_or_default(), cells.next().unwrap_or_default()) {
                ("Separator", "Tab") => style.separator = '\t',
                ("Separator", "Comma") => style.separator = ',',
                ("Decimal_Separator", sign) => {
                    style.decimal_comma = sign == "," || (sign.is_empty() && line.contains(','));
                }
                ("X_Columns", "No") => style.x_columns = XColumns::None,
                ("X_Columns", "One") => style.x_columns = XColumns::One,
                ("X_Columns", "Multi") => style.x_columns = XColumns::Multi,
                ("X_Columns", other) => {
                    return Err(self.source.malformed(
                        Self::place(number),
                        format!("X_Columns '{}'", shortened(other, 20)),
                        "No, One or Multi",
                    ));
                }
                _ => {}
            }
        }
        Err(self.source.malformed("the end", "no end of the file's header", END))
    }

    /// The next segment with numbers; none at the end of the file.
    fn segment(&mut self, style: &Style) -> Result<Option<Segment>, ReadError> {
        let mut segment = Segment::default();
        let mut channels = 0_usize;
        loop {
            let Some((number, line)) = self.rest.next() else { return Ok(None) };
            if line.trim().starts_with(END) {
                break;
            }
            let cells: Vec<&str> = line.split(style.separator).map(str::trim).collect();
            let numbers = || {
                cells[1..]
                    .iter()
                    .filter(|c| !c.is_empty())
                    .map(|c| number_of(c, style))
                    .collect::<Option<Vec<f64>>>()
            };
            let words = || cells[1..].iter().map(|c| plain(c)).collect();
            let wrong = || {
                self.source.malformed(
                    Self::place(number),
                    format!("'{}'", shortened(line, 60)),
                    "numbers for each channel",
                )
            };
            match cells[0] {
                "Channels" => {
                    channels = cells.get(1).and_then(|c| c.parse().ok()).unwrap_or(0);
                    if channels == 0 || channels > MOST_CHANNELS {
                        let found = format!("{} channels", shortened(cells.get(1).unwrap_or(&""), 20));
                        return Err(self.source.malformed(
                            Self::place(number),
                            found,
                            format!("1 to {MOST_CHANNELS}"),
                        ));
                    }
                }
                "Y_Unit_Label" => segment.units = words(),
                "X_Dimension" if cells[1..].iter().any(|c| !c.is_empty() && *c != "Time") => {
                    let found = format!("'{}' along X", shortened(&cells[1..].join(" "), 40));
                    return Err(self.source.unsupported(Self::place(number), found, "save time histories"));
                }
                "X_Unit_Label" => segment.x_units = words(),
                "X0" => segment.starts = numbers().ok_or_else(wrong)?,
                "Delta_X" => {
                    let values = numbers().ok_or_else(wrong)?;
                    let cells = cells[1..].iter().filter(|c| !c.is_empty());
                    let steps = values.into_iter().zip(cells);
                    segment.steps =
                        steps.map(|(step, cell)| Interval { step, digit: last_digit(cell) }).collect();
                }
                _ => {}
            }
        }
        if channels == 0 {
            return Err(self.source.malformed(
                "segment header",
                "no number of channels",
                "a line 'Channels'",
            ));
        }
        self.rows(style, channels, segment).map(Some)
    }

    /// The line of names and the rows below it.
    fn rows(&mut self, style: &Style, channels: usize, mut segment: Segment) -> Result<Segment, ReadError> {
        let xs = match style.x_columns {
            XColumns::None => 0,
            XColumns::One => 1,
            XColumns::Multi => channels,
        };
        let names: Vec<String> = self
            .rest
            .next()
            .map_or("", |(_, line)| line)
            .split(style.separator)
            .map(|n| plain(n.trim()))
            .collect();
        let multi = style.x_columns == XColumns::Multi;
        // Which column is which: X comes once in front of all channels, or in front of every channel. Where there is no X, LabVIEW leaves
        // its first column empty, and heads it X_Value or not at all.
        let column = |k: usize| if multi { 2 * k + 1 } else { k + xs };
        let empty_x = xs == 0 && matches!(names.first().map(String::as_str), Some("X_Value" | ""));
        let heading = |k: usize| column(k) + usize::from(empty_x);
        segment.names = (0..channels).map(|k| names.get(heading(k)).cloned().unwrap_or_default()).collect();
        segment.x_names = (0..xs).map(|k| names.get(2 * k).cloned().unwrap_or_default()).collect();
        (segment.x, segment.y) = (vec![Vec::new(); xs], vec![Vec::new(); channels]);
        while let Some((number, line)) = self.rest.peek().copied() {
            let cells: Vec<&str> = line.split(style.separator).map(str::trim).collect();
            let blank = cells.iter().all(|c| c.is_empty());
            // A comment may stand behind the last column. A word in the first column begins the header of the next segment.
            if !blank && number_of(cells[0], style).is_none() && !cells[0].is_empty() {
                break;
            }
            self.rest.next();
            if blank {
                continue;
            }
            // LabVIEW writes an empty first field where there is no X.
            let skip = usize::from(xs == 0 && cells[0].is_empty());
            let value = |at: usize| cells.get(at + skip).filter(|c| !c.is_empty());
            // Cells behind the last cell of a line belong to no channel, however many channels the header promises.
            for k in 0..channels.min(cells.len()) {
                let wrong = |found: &str| {
                    let place = format!("{}, column {}", Self::place(number), column(k) + skip + 1);
                    self.source.malformed(place, format!("'{}'", shortened(found, 40)), "a number")
                };
                // A channel may end before other channels.
                let Some(cell) = value(column(k)) else { continue };
                segment.y[k].push(number_of(cell, style).ok_or_else(|| wrong(cell))?);
                if multi || (xs == 1 && k == 0) {
                    let cell = value(if multi { 2 * k } else { 0 }).ok_or_else(|| wrong(""))?;
                    segment.x[k].push(number_of(cell, style).ok_or_else(|| wrong(cell))?);
                }
            }
        }
        Ok(segment)
    }
}

fn number_of(text: &str, style: &Style) -> Option<f64> {
    if style.decimal_comma { text.replace(',', ".").parse().ok() } else { text.parse().ok() }
}

/// Unit of the last digit of a number as written: 1e-6 for `0.000156`, 1e-11 for `1.953125E-5`.
fn last_digit(text: &str) -> f64 {
    let (mantissa, exponent) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
    let decimals = mantissa.split_once(['.', ',']).map_or(0, |(_, decimals)| decimals.len());
    10.0_f64.powf(exponent.parse().unwrap_or(0.0) - decimals as f64)
}
