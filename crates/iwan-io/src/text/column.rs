//! One column of a table, which may end before other columns.

use super::clock::Clocks;
use super::layout::{self, Layout};
use crate::error::ReadError;
use crate::file_bytes::{FileBytes, decode};
use iwan_machine::shortened;

/// A cell that holds no number.
pub(super) struct Fault {
    /// Line of the file, counted from 1.
    pub(super) line: u64,
    /// Column, counted from 1.
    column: usize,
    found: String,
}

impl Fault {
    pub(super) fn refusal(&self, source: &FileBytes) -> ReadError {
        let place = format!("line {}, column {}", self.line, self.column);
        source.malformed(place, format!("'{}'", self.found), "a number")
    }
}

/// One column. A column whose cells are empty from some row on is shorter than others; a column with an empty cell before its last number,
/// or with a word, has a hole.
#[derive(Default)]
pub(super) struct Column {
    /// Numbers up to the last number, NaN in holes.
    pub(super) values: Vec<f64>,
    /// The first cell that holds no number.
    pub(super) fault: Option<Fault>,
    pub(super) hole: bool,
    /// Number of cells without a number below the last number.
    without: usize,
    /// The times of day where the column holds these in place of numbers.
    clocks: Option<Clocks>,
}

impl Column {
    /// Adds the cell `field`; `line` is counted from 1, `column` of the file from 0.
    pub(super) fn push(&mut self, layout: &Layout, field: &[u8], (line, column): (u64, usize)) {
        if let Some(value) = self.value(layout, field) {
            self.hole |= self.without > 0;
            self.values.extend(std::iter::repeat_n(f64::NAN, std::mem::take(&mut self.without)));
            self.values.push(value);
        } else {
            self.hole |= !layout::is_blank(field);
            self.without += 1;
            let found = || shortened(&decode(field), 40);
            self.fault.get_or_insert_with(|| Fault { line, column: column + 1, found: found() });
        }
    }

    /// Whether the column holds times of day, which become seconds.
    pub(super) fn is_clock(&self) -> bool {
        self.clocks.is_some()
    }

    /// The number in a cell, or the seconds of a time of day where the column holds these.
    fn value(&mut self, layout: &Layout, field: &[u8]) -> Option<f64> {
        if self.clocks.is_none() {
            let number = layout.number(field);
            if number.is_some() || !self.values.is_empty() {
                return number;
            }
        }
        let clock = layout.clock(field)?;
        self.clocks.get_or_insert_default().seconds(clock)
    }
}
