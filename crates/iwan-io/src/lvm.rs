//! Measurement files of LabVIEW (`.lvm`): text with a header for the file, and one for each segment of data.
//!
//! Layout after "Specification for the LabVIEW Measurement File (.lvm)", National Instruments. Tabs, commas or what the header says
//! stand between fields, a comma may be the decimal sign, columns of X stand once, once a channel, or not at all. Segments with the
//! same channels that follow each other evenly are one record; others are refused by name.

use crate::assembly::{Axis, Channel, Raw, units};
use crate::error::ReadError;
use crate::file_bytes::{FileBytes, decode, list, shorten};
use crate::options::ReadOptions;
use crate::quantity::Quantity;
use crate::warning::Warning;

/// First word of the file.
const MAGIC: &[u8] = b"LabVIEW Measurement";
/// Last line of a header.
const END: &str = "***End_of_Header***";
/// Channels are refused beyond this number, as columns of other text files are: the file is damaged.
const MOST_CHANNELS: usize = 10_000;
/// The column of X and the header agree on the interval within this part of it, beside what X is rounded to.
const SAME: f64 = 0.01;
/// A segment continues the one before when it begins one interval behind its last sample, within this part of it: to the nearest sample.
const NEXT: f64 = 0.5;

/// Whether bytes begin as such a file does.
pub(crate) fn is_lvm(bytes: &[u8]) -> bool {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).starts_with(MAGIC)
}

/// What the header of the file says.
struct Style {
    separator: char,
    decimal_comma: bool,
    x_columns: XColumns,
}

/// Columns of X.
#[derive(Clone, Copy, PartialEq, Eq)]
enum XColumns {
    None,
    One,
    Multi,
}

/// One segment: its header's figures for each channel, and the numbers.
#[derive(Default)]
struct Segment {
    names: Vec<String>,
    units: Vec<String>,
    x_units: Vec<String>,
    starts: Vec<f64>,
    steps: Vec<f64>,
    x: Vec<Vec<f64>>,
    y: Vec<Vec<f64>>,
}

/// Lines with their numbers, counted from 1.
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
        // The separator stands behind the first words, before anything has said what it is.
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
                        format!("X_Columns '{}'", shorten(other, 20)),
                        "No, One or Multi",
                    ));
                }
                _ => {}
            }
        }
        Err(self.source.malformed("the end", "no end of the file's header", END))
    }

    /// The next segment with numbers; none at the end.
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
            let words = || cells[1..].iter().map(|c| (*c).to_string()).collect();
            let wrong = || {
                self.source.malformed(
                    Self::place(number),
                    format!("'{}'", shorten(line, 60)),
                    "numbers for each channel",
                )
            };
            match cells[0] {
                "Channels" => {
                    channels = cells.get(1).and_then(|c| c.parse().ok()).unwrap_or(0);
                    if channels == 0 || channels > MOST_CHANNELS {
                        let found = format!("{} channels", shorten(cells.get(1).unwrap_or(&""), 20));
                        return Err(self.source.malformed(
                            Self::place(number),
                            found,
                            format!("1 to {MOST_CHANNELS}"),
                        ));
                    }
                }
                "Y_Unit_Label" => segment.units = words(),
                "X_Dimension" if cells[1..].iter().any(|c| !c.is_empty() && *c != "Time") => {
                    let found = format!("'{}' along X", shorten(&cells[1..].join(" "), 40));
                    return Err(self.source.unsupported(Self::place(number), found, "save time histories"));
                }
                "X_Unit_Label" => segment.x_units = words(),
                "X0" => segment.starts = numbers().ok_or_else(wrong)?,
                "Delta_X" => segment.steps = numbers().ok_or_else(wrong)?,
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
        let names: Vec<&str> =
            self.rest.next().map_or("", |(_, line)| line).split(style.separator).map(str::trim).collect();
        let multi = style.x_columns == XColumns::Multi;
        // Which column is which: X once in front, or in front of every channel. LabVIEW heads a column of X even where there is none.
        let column = |k: usize| if multi { 2 * k + 1 } else { k + xs };
        let heading =
            |k: usize| if xs == 0 { k + usize::from(names.first() == Some(&"X_Value")) } else { column(k) };
        segment.names = (0..channels)
            .map(|k| names.get(heading(k)).map_or(String::new(), |n| (*n).to_string()))
            .collect();
        (segment.x, segment.y) = (vec![Vec::new(); xs], vec![Vec::new(); channels]);
        while let Some((number, line)) = self.rest.peek().copied() {
            let cells: Vec<&str> = line.split(style.separator).map(str::trim).collect();
            let blank = cells.iter().all(|c| c.is_empty());
            // A comment may stand behind the last column; a word in front begins the header of the next segment.
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
            // What stands behind the last cell of a line is no channel's, however many the header promises.
            for k in 0..channels.min(cells.len()) {
                let wrong = |found: &str| {
                    let place = format!("{}, column {}", Self::place(number), column(k) + skip + 1);
                    self.source.malformed(place, format!("'{}'", shorten(found, 40)), "a number")
                };
                // Channels may end before others do.
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

impl Segment {
    /// Interval and start of its samples as the header has them.
    fn even(&self) -> Option<(f64, f64)> {
        let step = self.steps.first().copied().filter(|s| *s > 0.0 && s.is_finite())?;
        Some((self.starts.first().copied().unwrap_or(0.0), step))
    }

    /// What the column of X says against the header's interval: programs that thin samples out leave the header as it was.
    fn contradiction(&self) -> Option<String> {
        let ((_, step), x) = (self.even()?, self.x.first()?);
        // X may begin anew with each segment, and be written with so few digits that neighbours are equal: the mean up to the first step back.
        let steps: Vec<f64> = x.windows(2).map(|w| w[1] - w[0]).take_while(|d| *d >= 0.0).collect();
        let count = steps.len().max(1) as f64;
        let seen = steps.iter().sum::<f64>() / count;
        let digit = steps.iter().copied().filter(|d| *d > 0.0).fold(f64::INFINITY, f64::min);
        let differs = (seen - step).abs() > SAME * step + digit / count;
        differs.then(|| format!("steps of {seen:.6e} in the column X_Value where Delta_X is {step:.6e}"))
    }

    /// Puts another segment behind this one, where it continues it; says why not otherwise.
    fn append(&mut self, other: Self) -> Result<(), String> {
        if other.y.iter().all(Vec::is_empty) {
            return Ok(());
        }
        if self.y.len() != other.y.len() || self.names != other.names {
            return Err("segments of different channels".into());
        }
        let samples = self.y.first().map_or(0, Vec::len);
        let (Some((start, step)), Some((next, other_step))) = (self.even(), other.even()) else {
            return Err("several segments without a start and an interval".into());
        };
        let gap = next - (start + samples as f64 * step);
        if (other_step - step).abs() > 1e-9 * step || gap.is_nan() || gap.abs() > NEXT * step {
            return Err(format!(
                "segments that do not follow each other (the next begins {gap:.6e} s away from where it would)"
            ));
        }
        for (mine, more) in self.y.iter_mut().zip(other.y).chain(self.x.iter_mut().zip(other.x)) {
            mine.extend(more);
        }
        Ok(())
    }

    fn into_raw(self, source: &FileBytes, options: &ReadOptions) -> Result<Raw, ReadError> {
        let unit = self.x_units.first().map_or("", String::as_str);
        let (factor, unit_known) = source.seconds("X", unit, options)?;
        let mut warnings = Vec::new();
        if factor != 1.0 {
            warnings.push(Warning::TimeScaled { unit: unit.into(), factor });
        }
        if options.rate.is_none()
            && let Some(contradiction) = self.contradiction()
        {
            let expected = "one interval in both; say the rate with --rate";
            return Err(source.malformed("X_Value and Delta_X", contradiction, expected));
        }
        let axis = match (self.even(), self.x.first()) {
            (Some((start, step)), _) => Axis::Even { start: factor * start, step: factor * step },
            (None, Some(times)) => {
                let values = times.iter().map(|t| factor * t).collect();
                Axis::Times { name: "X".into(), values, unit_known: unit_known || !unit.is_empty() }
            }
            (None, None) => Axis::None,
        };
        let name = |k: usize| match self.names.get(k).map(String::as_str) {
            None | Some("") => format!("channel {}", k + 1),
            Some(name) => name.to_string(),
        };
        let names: Vec<String> = (0..self.y.len()).map(name).collect();
        let chosen = !options.channels.is_empty();
        let place = |name: &String| {
            names.iter().position(|n| n == name).ok_or_else(|| {
                let (file, names) = (source.file.into(), list(names.iter().map(String::as_str)));
                ReadError::UnknownName { file, role: "channel", name: name.clone(), names }
            })
        };
        // LabVIEW lets several channels have one name: where none is asked for by it, each is the one at its place.
        let wanted: Vec<usize> = if chosen {
            options.channels.iter().map(place).collect::<Result<_, _>>()?
        } else {
            (0..names.len()).collect()
        };
        let channel = |k: usize| {
            let (name, unit) = (names[k].clone(), self.units.get(k).cloned().unwrap_or_default());
            let mut quantity = units::quantity_of_unit(&unit);
            if quantity == Quantity::Unknown && unit.is_empty() {
                quantity = units::quantity_of_name(&name);
            }
            Channel { name, unit, quantity, values: self.y[k].clone() }
        };
        let channels = wanted.into_iter().map(channel).collect();
        Ok(Raw { axis, channels, chosen, warnings })
    }
}
