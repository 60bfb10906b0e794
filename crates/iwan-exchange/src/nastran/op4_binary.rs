//! OP4 in binary: Fortran records, both byte orders, words of 4 or 8 bytes.
#![allow(clippy::cast_possible_wrap, reason = "lengths of files in memory and of words are below 2^63")]

use super::op4::{Head, Layout};
use crate::error::ExchangeError;
use crate::matrix::{Entry, Matrix};
use crate::source::Source;

/// Byte order and word size of a file.
#[derive(Debug, Clone, Copy)]
struct Words {
    big: bool,
    /// Bytes of a word: 4, or 8 where Nastran runs with ILP64.
    size: usize,
}

impl Words {
    /// Byte order and word size from the length of the first record, the header: 24 bytes of 4-byte words or 48 bytes of 8-byte words.
    fn of(source: &Source) -> Result<Self, ExchangeError> {
        let first = source.bytes.first_chunk::<4>().copied().unwrap_or_default();
        let lengths = [(u32::from_le_bytes(first), false), (u32::from_be_bytes(first), true)];
        let known = lengths.iter().find_map(|&(length, big)| match length {
            24 => Some(Self { big, size: 4 }),
            48 => Some(Self { big, size: 8 }),
            _ => None,
        });
        known.ok_or_else(|| {
            let expected =
                "a first record of 24 or 48 bytes, in either byte order: the header of an OP4 matrix";
            source.malformed("byte 1", format!("a record of {} bytes", lengths[0].0), expected)
        })
    }

    fn record_length(self, raw: [u8; 4]) -> usize {
        (if self.big { u32::from_be_bytes(raw) } else { u32::from_le_bytes(raw) }) as usize
    }

    /// The word with index `at` (from 0) of some bytes.
    fn word(self, bytes: &[u8], at: usize) -> Option<i64> {
        let bytes = bytes.get(at * self.size..)?;
        if self.size == 8 {
            let raw = *bytes.first_chunk()?;
            return Some(if self.big { i64::from_be_bytes(raw) } else { i64::from_le_bytes(raw) });
        }
        let raw = *bytes.first_chunk()?;
        Some(i64::from(if self.big { i32::from_be_bytes(raw) } else { i32::from_le_bytes(raw) }))
    }

    /// Bytes of a value: in files of 8-byte words values of both precisions have 8 bytes.
    fn value_size(self, single: bool) -> usize {
        if single { self.size } else { 8 }
    }

    fn value(self, bytes: &[u8], single: bool) -> Option<f64> {
        if self.value_size(single) == 4 {
            let raw = *bytes.first_chunk()?;
            return Some(f64::from(if self.big { f32::from_be_bytes(raw) } else { f32::from_le_bytes(raw) }));
        }
        let raw = *bytes.first_chunk()?;
        Some(if self.big { f64::from_be_bytes(raw) } else { f64::from_le_bytes(raw) })
    }
}

/// The Fortran records of the file.
struct Records<'s, 'a> {
    source: &'s Source<'a>,
    words: Words,
    at: usize,
}

impl<'a> Records<'_, 'a> {
    fn place(&self) -> String {
        format!("byte {}", self.at + 1)
    }

    /// The next record, none at the end of the file.
    fn next(&mut self) -> Result<Option<&'a [u8]>, ExchangeError> {
        let rest = &self.source.bytes[self.at.min(self.source.bytes.len())..];
        if rest.is_empty() {
            return Ok(None);
        }
        let place = self.place();
        let length = rest.first_chunk().map(|raw| self.words.record_length(*raw));
        let record = length.and_then(|length| {
            let end = rest.get(4 + length..)?.first_chunk().map(|raw| self.words.record_length(*raw))?;
            (end == length).then(|| &rest[4..4 + length])
        });
        let Some(record) = record else {
            let found = match length {
                Some(length) => format!("a record of {length} bytes without its end"),
                None => "less than a record".to_string(),
            };
            return Err(self.source.malformed(
                place,
                found,
                "a whole Fortran record, its length before and behind",
            ));
        };
        self.at += record.len() + 8;
        Ok(Some(record))
    }
}

pub(crate) fn parse(source: &Source) -> Result<Vec<Matrix>, ExchangeError> {
    let mut records = Records { source, words: Words::of(source)?, at: 0 };
    let mut matrices = Vec::new();
    loop {
        let place = records.place();
        let Some(record) = records.next()? else { return Ok(matrices) };
        let words = records.words;
        let numbers: Option<Vec<i64>> = (0..4).map(|at| words.word(record, at)).collect();
        let name = record.get(4 * words.size..);
        let (Some(numbers), Some(name)) = (numbers.filter(|_| record.len() == 6 * words.size), name) else {
            let found = format!("a record of {} bytes", record.len());
            let expected = format!("the header of a matrix, {} bytes", 6 * words.size);
            return Err(source.malformed(place, found, expected));
        };
        let head = Head::new(source, &place, [numbers[0], numbers[1], numbers[2], numbers[3]], name)?;
        matrices.push(matrix(&mut records, head)?);
    }
}

fn matrix(records: &mut Records, head: Head) -> Result<Matrix, ExchangeError> {
    let (source, words) = (records.source, records.words);
    let mut entries = Vec::new();
    loop {
        let place = records.place();
        let Some(record) = records.next()? else {
            return Err(source.ends(format!("the record behind the last column of matrix {}", head.name)));
        };
        let heads = [0, 1, 2].map(|at| words.word(record, at));
        let [Some(column), Some(row), Some(count)] = heads else {
            let found = format!("a record of {} bytes", record.len());
            return Err(source.malformed(
                place,
                found,
                format!("column, row and words of matrix {}", head.name),
            ));
        };
        if column > head.columns as i64 {
            return Ok(head.matrix(entries));
        }
        let data = &record[3 * words.size..];
        // Programs differ in whether a double-precision value counts as two words where words have 8 bytes: the record's own length shows
        // where the data end.
        if column < 1 || count < 0 || !(0..=data.len() as i64).contains(&count) {
            let found = format!("column {column} with {count} words in {} bytes", data.len());
            let expected = format!("a column from 1 on, within the record, of matrix {}", head.name);
            return Err(source.malformed(place, found, expected));
        }
        let mut strings = Strings { source, words, head: &head, place, column, data };
        strings.read(row, &mut entries)?;
    }
}

/// The strings of a column: runs of values in consecutive rows.
struct Strings<'r, 's, 'a> {
    source: &'s Source<'a>,
    words: Words,
    head: &'r Head,
    place: String,
    column: i64,
    data: &'a [u8],
}

impl Strings<'_, '_, '_> {
    fn read(&mut self, row: i64, entries: &mut Vec<Entry>) -> Result<(), ExchangeError> {
        let size = self.words.value_size(self.head.single);
        let layout = self.head.layout(row);
        if layout == Layout::Dense {
            return self.values([row, (self.data.len() / size) as i64], entries);
        }
        while !self.data.is_empty() {
            let first = self.words.word(self.data, 0);
            let (length, row, taken) = match (layout, first) {
                (Layout::BigMat, Some(length)) => {
                    (length.saturating_sub(1), self.words.word(self.data, 1).unwrap_or(0), 2)
                }
                (_, Some(word)) => {
                    let (length, row) = Head::unpack(word);
                    (length, row, 1)
                }
                (_, None) => (0, 0, 1),
            };
            self.data = self.data.get(taken * self.words.size..).unwrap_or_default();
            let bytes =
                usize::try_from(length).ok().and_then(|n| n.checked_mul(self.words.size)).unwrap_or(0);
            if bytes == 0 || bytes > self.data.len() || !bytes.is_multiple_of(size) {
                let found = format!(
                    "a string of {length} words in {} bytes of column {}",
                    self.data.len(),
                    self.column
                );
                return Err(self.source.malformed(self.place.clone(), found, "a string within the column"));
            }
            self.values([row, (bytes / size) as i64], entries)?;
        }
        Ok(())
    }

    /// Reads `count` values from row `row` on.
    fn values(&mut self, [row, count]: [i64; 2], entries: &mut Vec<Entry>) -> Result<(), ExchangeError> {
        let first = self.head.check(self.source, &self.place, self.column as u64, [row, count])?;
        let size = self.words.value_size(self.head.single);
        let (values, rest) = self.data.split_at(count as usize * size);
        for (k, raw) in values.chunks_exact(size).enumerate() {
            let value = self.words.value(raw, self.head.single).unwrap_or(f64::NAN);
            if !value.is_finite() {
                let found = format!("{value} in row {} of column {}", first as usize + k + 1, self.column);
                let place = format!("{}, matrix {}", self.place, self.head.name);
                return Err(self.source.malformed(place, found, "finite numbers"));
            }
            let (entry, part) = (k / self.head.parts(), k % self.head.parts());
            if value != 0.0 && part == 0 {
                entries.push((first + entry as u32, self.column as u32 - 1, value));
            }
        }
        self.data = rest;
        Ok(())
    }
}
