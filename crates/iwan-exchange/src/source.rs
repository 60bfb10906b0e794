//! A file in memory that names itself in every error; its lines and the numbers on them.

use std::fmt::Display;
use std::path::Path;

use crate::error::ExchangeError;

/// Largest number of rows or columns, since their indices are kept in 32 bits. Larger matrices are refused.
pub(crate) const MOST_ROWS: u64 = u32::MAX as u64;

/// A file in memory.
#[derive(Clone, Copy)]
pub(crate) struct Source<'a> {
    pub(crate) file: &'a Path,
    pub(crate) bytes: &'a [u8],
}

impl<'a> Source<'a> {
    pub(crate) fn malformed(
        &self,
        place: impl Into<String>,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> ExchangeError {
        let (place, found, expected) = (place.into(), found.into(), expected.into());
        ExchangeError::Malformed { file: self.file.into(), place, found, expected }
    }

    pub(crate) fn unsupported(
        &self,
        place: impl Into<String>,
        found: impl Into<String>,
        remedy: impl Into<String>,
    ) -> ExchangeError {
        let (place, found, remedy) = (place.into(), found.into(), remedy.into());
        ExchangeError::Unsupported { file: self.file.into(), place, found, remedy }
    }

    /// The lines of the file that are not blank.
    pub(crate) fn lines(&self) -> Lines<'a> {
        Lines { bytes: self.bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(self.bytes), at: 0, number: 0 }
    }

    /// A finite number on a line.
    pub(crate) fn number(&self, line: &Line, field: &[u8], what: impl Display) -> Result<f64, ExchangeError> {
        number(field).ok_or_else(|| {
            let expected = format!("{what}: a finite number");
            self.malformed(line.place(), quote(field, 40), expected)
        })
    }

    /// A whole number from `least` to `most` on a line.
    pub(crate) fn whole(
        &self,
        line: &Line,
        field: &[u8],
        [least, most]: [u64; 2],
        what: impl Display,
    ) -> Result<u64, ExchangeError> {
        let value: Option<u64> = std::str::from_utf8(field).ok().and_then(|text| text.parse().ok());
        value.filter(|n| (least..=most).contains(n)).ok_or_else(|| {
            let expected = format!("{what}: a whole number from {least} to {most}");
            self.malformed(line.place(), quote(field, 40), expected)
        })
    }

    /// The error of a file that ends too early.
    pub(crate) fn ends(&self, expected: impl Into<String>) -> ExchangeError {
        self.malformed("the end of the file", "nothing more", expected)
    }
}

/// A finite number. The exponent may have the letter `D`, or no letter (`1.5-3`), as Fortran writes it.
pub(crate) fn number(field: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(field).ok()?.trim_ascii();
    let plain = || {
        let lower = text.to_ascii_lowercase();
        let with_letter = lower.replacen('d', "e", 1);
        let sign = lower.char_indices().skip(1).find(|(at, c)| {
            matches!(c, '+' | '-')
                && lower.as_bytes()[at - 1].is_ascii_digit() | (lower.as_bytes()[at - 1] == b'.')
        });
        let bare = sign.map(|(at, _)| format!("{}e{}", &lower[..at], &lower[at..]));
        with_letter.parse::<f64>().ok().or_else(|| bare?.parse().ok())
    };
    text.parse::<f64>().ok().or_else(plain).filter(|value| value.is_finite())
}

/// One line, without the blanks at its ends unless read by [`Lines::raw`].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Line<'a> {
    /// Number of the line, counted from 1.
    pub(crate) number: usize,
    pub(crate) text: &'a [u8],
}

impl<'a> Line<'a> {
    pub(crate) fn place(&self) -> String {
        format!("line {}", self.number)
    }

    pub(crate) fn quoted(&self) -> String {
        quote(self.text, 60)
    }

    /// Fields between blanks, tabs, commas or semicolons; none is empty.
    pub(crate) fn fields(&self) -> impl Iterator<Item = &'a [u8]> + use<'a> {
        let separates = |b: &u8| b.is_ascii_whitespace() || matches!(b, b',' | b';');
        self.text.split(separates).filter(|field| !field.is_empty())
    }

    /// The fields of a line that has exactly `N` of them; none where there are fewer or more.
    pub(crate) fn exactly<const N: usize>(&self) -> Option<[&'a [u8]; N]> {
        let mut fields = self.fields();
        let mut out = [&b""[..]; N];
        for place in &mut out {
            *place = fields.next()?;
        }
        fields.next().is_none().then_some(out)
    }
}

/// The lines of a file that are not blank.
pub(crate) struct Lines<'a> {
    bytes: &'a [u8],
    at: usize,
    number: usize,
}

impl<'a> Lines<'a> {
    /// The next line as it stands, with its blanks but without the line end; it may be empty.
    pub(crate) fn raw(&mut self) -> Option<Line<'a>> {
        let rest = self.bytes.get(self.at..).filter(|rest| !rest.is_empty())?;
        let end = rest.iter().position(|b| *b == b'\n').unwrap_or(rest.len());
        self.at += (end + 1).min(rest.len());
        self.number += 1;
        let text = rest[..end].strip_suffix(b"\r").unwrap_or(&rest[..end]);
        Some(Line { number: self.number, text })
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = Line<'a>;

    fn next(&mut self) -> Option<Line<'a>> {
        loop {
            let line = self.raw()?;
            let text = line.text.trim_ascii();
            if !text.is_empty() {
                return Some(Line { text, ..line });
            }
        }
    }
}

/// The beginning of some bytes for a message: readable, at most `limit` characters, in quotes.
pub(crate) fn quote(bytes: &[u8], limit: usize) -> String {
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(4 * limit)]);
    let mut short: String = text.chars().take(limit).map(|c| if c.is_control() { '.' } else { c }).collect();
    if text.chars().count() > limit || bytes.len() > 4 * limit {
        short.push_str("...");
    }
    format!("'{short}'")
}

#[cfg(test)]
mod tests {
    use super::number;

    #[test]
    fn numbers_of_fortran_are_understood() {
        for (text, expected) in [
            ("1.5D+03", Some(1500.0)),
            ("-2.d-1", Some(-0.2)),
            ("1.5-3", Some(1.5e-3)),
            ("-1.+2", Some(-100.0)),
            ("7", Some(7.0)),
            ("1e400", None),
            ("nan", None),
            ("inf", None),
            ("-", None),
            ("", None),
            ("1.5-", None),
            ("0x10", None),
        ] {
            assert_eq!(number(text.as_bytes()), expected, "{text}");
        }
    }
}
