//! What OP4 files in text and in binary have in common (NX Nastran User's Guide, "OUTPUT4"; MSC Nastran DMAP Guide, OUTPUT4).
#![allow(clippy::cast_possible_wrap, reason = "lengths of files in memory and of words are below 2^63")]

use crate::error::ExchangeError;
use crate::matrix::{Entry, Matrix, Stored};
use crate::source::{MOST_ROWS, Source};

/// Header of a matrix.
pub(super) struct Head {
    pub(super) name: String,
    pub(super) rows: u64,
    pub(super) columns: u64,
    /// Strings (runs of values in consecutive rows) of sparse matrices have their row in a word of its own: the file states rows < 0, or
    /// more rows than 16 bits can count.
    pub(super) bigmat: bool,
    /// Values are single precision, and each counts as one word.
    pub(super) single: bool,
    /// Each entry has a real and an imaginary part.
    pub(super) complex: bool,
}

/// How the strings of a column are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Layout {
    /// One string, which begins at a stated row.
    Dense,
    /// Strings whose length and row stand in two words.
    BigMat,
    /// Strings whose length and row share one word.
    Packed,
}

/// From this number of rows on, length and row of a string stand in two words, whatever the sign of the number of rows: the number of a row
/// no longer fits into 16 bits.
const BIGMAT_ROWS: i64 = 65_536;

impl Head {
    /// A header from its numbers and name.
    pub(super) fn new(
        source: &Source,
        place: &str,
        [columns, rows, _form, kind]: [i64; 4],
        name: &[u8],
    ) -> Result<Self, ExchangeError> {
        let name = String::from_utf8_lossy(name).trim_matches([' ', '\0']).to_string();
        let place = format!("{place}, matrix {name}");
        let size = |value: i64, what: &str| {
            let count = value.unsigned_abs();
            if count > MOST_ROWS {
                let expected = format!("the number of {what}: at most {MOST_ROWS}");
                return Err(source.malformed(place.clone(), value.to_string(), expected));
            }
            Ok(count)
        };
        let (count, columns) = (size(rows, "rows")?, size(columns.max(0), "columns")?);
        if !(1..=4).contains(&kind) {
            let expected = "the type of the matrix: 1 or 2 (real), 3 or 4 (complex)";
            return Err(source.malformed(place, kind.to_string(), expected));
        }
        let (single, complex) = (kind % 2 == 1, kind > 2);
        Ok(Self { name, rows: count, columns, bigmat: !(0..BIGMAT_ROWS).contains(&rows), single, complex })
    }

    /// Layout of a column from the row that the column states; row 0 stands for sparse strings.
    pub(super) fn layout(&self, row: i64) -> Layout {
        match (row, self.bigmat) {
            (1.., _) => Layout::Dense,
            (_, true) => Layout::BigMat,
            (_, false) => Layout::Packed,
        }
    }

    /// Number of words of a value where words have 4 bytes.
    pub(super) fn words(&self) -> usize {
        if self.single { 1 } else { 2 }
    }

    /// Number of values of an entry.
    pub(super) fn parts(&self) -> usize {
        if self.complex { 2 } else { 1 }
    }

    /// Length in words (the word with length and row not counted) and row, unpacked from the word that holds both.
    pub(super) fn unpack(word: i64) -> (i64, i64) {
        ((word >> 16) - 1, word & 0xffff)
    }

    /// Checks that a string of `count` values from `row` (from 1) on lies in the matrix.
    pub(super) fn check(
        &self,
        source: &Source,
        place: &str,
        column: u64,
        [row, numbers]: [i64; 2],
    ) -> Result<u32, ExchangeError> {
        let count = numbers / self.parts() as i64;
        let inside = row >= 1
            && count >= 0
            && numbers % self.parts() as i64 == 0
            // With words of eight bytes, the sum of row and count may exceed the range of a word.
            && (row - 1).saturating_add(count) as u64 <= self.rows;
        if inside {
            return Ok(row as u32 - 1);
        }
        let found = format!("{count} values from row {row} on in column {column}");
        let place = format!("{place}, matrix {}", self.name);
        Err(source.malformed(place, found, format!("a string within {} rows", self.rows)))
    }

    /// The matrix with these entries.
    pub(super) fn matrix(self, entries: Vec<Entry>) -> Matrix {
        let (rows, columns) = (self.rows as usize, self.columns as usize);
        Matrix {
            name: self.name,
            rows,
            columns,
            entries,
            stored: Stored::All,
            labels: None,
            complex: self.complex,
        }
    }
}
