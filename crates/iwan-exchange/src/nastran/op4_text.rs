//! OP4 as text.
#![allow(clippy::cast_possible_wrap, reason = "lengths of files in memory and of words are below 2^63")]

use super::op4::{Head, Layout};
use crate::error::ExchangeError;
use crate::matrix::{Entry, Matrix};
use crate::source::{Line, Lines, Source, number, quote};

/// Width in characters of the whole numbers in the header lines of columns and strings (a string is a run of values in consecutive rows).
const WIDTH: usize = 8;
/// Largest width of a field in characters, and largest number of fields in a line: Fortran's 1P,1E80 would be wider than a line. Formats
/// beyond it are refused.
const WIDEST: usize = 80;

/// Lines of numbers in fields of one width.
struct Reader<'s, 'a> {
    source: &'s Source<'a>,
    lines: Lines<'a>,
    /// Characters of a value, and number of values in a line.
    width: usize,
    per_line: usize,
}

pub(crate) fn parse(source: &Source) -> Result<Vec<Matrix>, ExchangeError> {
    let mut reader = Reader { source, lines: source.lines(), width: 16, per_line: 5 };
    let mut matrices = Vec::new();
    while let Some(line) = reader.lines.raw() {
        if line.text.trim_ascii().is_empty() {
            continue;
        }
        let head = reader.head(&line)?;
        matrices.push(reader.matrix(head)?);
    }
    if matrices.is_empty() { Err(source.ends("the header of a matrix")) } else { Ok(matrices) }
}

impl<'a> Reader<'_, 'a> {
    fn line(&mut self, expected: &str) -> Result<Line<'a>, ExchangeError> {
        self.lines.raw().ok_or_else(|| self.source.ends(expected))
    }

    /// The whole number in columns `from` to `to` of a line.
    fn field(&self, line: &Line, [from, to]: [usize; 2], what: &str) -> Result<i64, ExchangeError> {
        let bytes = line.text.get(from..to.min(line.text.len())).unwrap_or_default().trim_ascii();
        std::str::from_utf8(bytes).ok().and_then(|text| text.parse().ok()).ok_or_else(|| {
            let expected = format!("{what} in columns {} to {to}", from + 1);
            self.source.malformed(line.place(), quote(bytes, 40), expected)
        })
    }

    fn head(&mut self, line: &Line) -> Result<Head, ExchangeError> {
        let text = line.text.trim_ascii_end();
        let wide = text.ends_with(b"|I16");
        let (w, text) = if wide { (16, &text[..text.len() - 4]) } else { (8, text) };
        let columns = self.field(line, [0, w], "the number of columns")?;
        let rows = self.field(line, [w, 2 * w], "the number of rows")?;
        let form = self.field(line, [2 * w, 2 * w + 8], "the form")?;
        let kind = self.field(line, [2 * w + 8, 2 * w + 16], "the type")?;
        let rest = text.get(2 * w + 16..).unwrap_or_default();
        let name = &rest[..rest.len().min(8)];
        (self.per_line, self.width) = match rest.get(8..).map(<[u8]>::trim_ascii).filter(|f| !f.is_empty()) {
            None => (5, 16),
            Some(format) => self.format(line, format)?,
        };
        Head::new(self.source, &line.place(), [columns, rows, form, kind], name)
    }

    /// Number of values in a line, and characters of a value, from a Fortran format such as `1P,3E23.16`.
    fn format(&self, line: &Line, text: &[u8]) -> Result<(usize, usize), ExchangeError> {
        let upper = String::from_utf8_lossy(text).to_ascii_uppercase();
        let body = upper.strip_prefix("1P").unwrap_or(&upper).trim_start_matches(',');
        let parts = body.split_once(['E', 'D']);
        let numbers = parts.and_then(|(count, rest)| {
            let width = rest.split('.').next()?;
            Some((count.trim().parse().ok()?, width.trim().parse().ok()?))
        });
        numbers
            .filter(|&(count, width)| (1..=WIDEST).contains(&count) && (1..=WIDEST).contains(&width))
            .ok_or_else(|| {
                self.source.malformed(line.place(), quote(text, 40), "a format such as 1P,3E23.16")
            })
    }

    fn matrix(&mut self, head: Head) -> Result<Matrix, ExchangeError> {
        let mut entries = Vec::new();
        loop {
            let line = self.line("the next column, or the one behind the last")?;
            let column = self.field(&line, [0, WIDTH], "the column")?;
            let row = self.field(&line, [WIDTH, 2 * WIDTH], "the row of the column")?;
            let words = self.field(&line, [2 * WIDTH, 3 * WIDTH], "the number of words")?;
            if column > head.columns as i64 {
                // The column behind the last one carries a value without meaning.
                self.lines.raw();
                return Ok(head.matrix(entries));
            }
            if column < 1 || words < 0 {
                let expected = "a column >= 1 with words >= 0";
                return Err(self.source.malformed(line.place(), line.quoted(), expected));
            }
            self.column(&head, &line, [column, row, words], &mut entries)?;
        }
    }

    fn column(
        &mut self,
        head: &Head,
        line: &Line,
        [column, row, words]: [i64; 3],
        entries: &mut Vec<Entry>,
    ) -> Result<(), ExchangeError> {
        let layout = head.layout(row);
        if layout == Layout::Dense {
            return self.values(head, line, column, [row, words], entries);
        }
        let mut left = words;
        while left > 0 {
            let line = self.line("the next string of the column")?;
            let (length, row, taken) = if layout == Layout::BigMat {
                let length = self.field(&line, [0, WIDTH], "the length of the string")? - 1;
                (length, self.field(&line, [WIDTH, 2 * WIDTH], "the row of the string")?, length + 2)
            } else {
                let word = self.field(&line, [0, line.text.len()], "length and row of the string")?;
                let (length, row) = Head::unpack(word);
                (length, row, length + 1)
            };
            if length < 1 || taken > left {
                let expected = format!("a string of at most the {left} words left in column {column}");
                return Err(self.source.malformed(line.place(), line.quoted(), expected));
            }
            left -= taken;
            self.values(head, &line, column, [row, length / head.words() as i64], entries)?;
        }
        Ok(())
    }

    /// Reads `count` values from row `row` on.
    fn values(
        &mut self,
        head: &Head,
        line: &Line,
        column: i64,
        [row, count]: [i64; 2],
        entries: &mut Vec<Entry>,
    ) -> Result<(), ExchangeError> {
        let first = head.check(self.source, &line.place(), column as u64, [row, count])?;
        let mut at = 0;
        while at < count as u32 {
            let line = self.line("values of the column")?;
            for k in 0..self.per_line.min((count as u32 - at) as usize) {
                let field = line.text.get(k * self.width..((k + 1) * self.width).min(line.text.len()));
                let value = field.and_then(number).ok_or_else(|| {
                    let expected = format!("{} finite numbers of {} characters", self.per_line, self.width);
                    self.source.malformed(line.place(), line.quoted(), expected)
                })?;
                let (entry, part) = (at / head.parts() as u32, at % head.parts() as u32);
                if value != 0.0 && part == 0 {
                    entries.push((first + entry, column as u32 - 1, value));
                }
                at += 1;
            }
        }
        Ok(())
    }
}
