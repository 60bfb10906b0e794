//! Rows of numbers of a dataset in text.

use super::sections::{Other, line_at};
use crate::error::ReadError;
use crate::file_bytes::{FileBytes, decode};
use iwan_machine::shortened;

/// Rows of numbers of a dataset.
pub(super) struct Rows<'s, 'a> {
    source: &'s FileBytes<'a>,
    body: &'a [u8],
    at: usize,
    row: usize,
    place: String,
}

impl<'s, 'a> Rows<'s, 'a> {
    pub(super) fn new(source: &'s FileBytes<'a>, other: &Other<'a>) -> Self {
        let place = format!("dataset {} at byte {}", other.number, other.offset);
        Self { source, body: other.body, at: 0, row: 0, place }
    }

    /// The next row as it stands; none at the end.
    pub(super) fn next(&mut self) -> Option<String> {
        let (line, next) = line_at(self.body, self.at)?;
        (self.at, self.row) = (next, self.row + 1);
        Some(decode(line))
    }

    /// Whether only empty rows follow.
    pub(super) fn ended(&self) -> bool {
        self.body[self.at..].iter().all(u8::is_ascii_whitespace)
    }

    pub(super) fn wrong(&self, found: &str, expected: &'static str) -> ReadError {
        self.source.malformed(
            format!("{}, row {}", self.place, self.row),
            format!("'{}'", shortened(found, 60)),
            expected,
        )
    }

    /// `count` numbers from the next rows; each number is `width` characters wide, and each row holds `a_row` numbers.
    pub(super) fn numbers(
        &mut self,
        count: usize,
        (width, a_row): (usize, usize),
        what: &'static str,
    ) -> Result<Vec<f64>, ReadError> {
        let mut numbers = Vec::new();
        while numbers.len() < count {
            let wanted = (count - numbers.len()).min(a_row);
            let text = self.next().unwrap_or_default();
            let own = row(&text, width, wanted).ok_or_else(|| self.wrong(&text, what))?;
            numbers.extend(own);
        }
        Ok(numbers)
    }

    /// All whole numbers of one row; an error where there are fewer than `least`.
    pub(super) fn integers(&mut self, least: usize, what: &'static str) -> Result<Vec<i64>, ReadError> {
        let text = self.next().unwrap_or_default();
        let all: Option<Vec<i64>> = text.split_whitespace().map(|f| f.parse().ok()).collect();
        all.filter(|all| all.len() >= least).ok_or_else(|| self.wrong(&text, what))
    }
}

/// `wanted` numbers of a row, separated by blanks, or else each `width` characters wide: negative numbers may leave no blank between them.
pub(super) fn row(text: &str, width: usize, wanted: usize) -> Option<Vec<f64>> {
    let number = |field: &str| {
        let value: f64 = field.trim().replace(['D', 'd'], "e").parse().ok()?;
        value.is_finite().then_some(value)
    };
    let apart: Vec<&str> = text.split_whitespace().collect();
    if apart.len() >= wanted {
        let all: Option<Vec<f64>> = apart[..wanted].iter().map(|f| number(f)).collect();
        if all.is_some() {
            return all;
        }
    }
    (0..wanted).map(|i| text.get(i * width..((i + 1) * width).min(text.len())).and_then(number)).collect()
}
