//! Data elements of a level 5 file: a tag of type and size, then data padded to eight bytes.

use crate::bytes::{self, Order, u32_at};
use crate::error::ReadError;
use crate::file_bytes::FileBytes;

/// Type of a data element.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ElementType {
    Number(bytes::NumberType),
    /// UTF-8, UTF-16 or UTF-32 text, with the number of bytes of one code unit.
    Text(usize),
    Matrix,
    Compressed,
    Other,
}

impl ElementType {
    fn of(code: u32) -> Self {
        use bytes::NumberType::{F32, F64, I8, I16, I32, I64, U8, U16, U32, U64};
        match code {
            1 => Self::Number(I8),
            2 => Self::Number(U8),
            3 => Self::Number(I16),
            4 => Self::Number(U16),
            5 => Self::Number(I32),
            6 => Self::Number(U32),
            7 => Self::Number(F32),
            9 => Self::Number(F64),
            12 => Self::Number(I64),
            13 => Self::Number(U64),
            14 => Self::Matrix,
            15 => Self::Compressed,
            16 => Self::Text(1),
            17 => Self::Text(2),
            18 => Self::Text(4),
            _ => Self::Other,
        }
    }
}

/// One data element.
#[derive(Debug, Clone, Copy)]
pub(super) struct Element<'a> {
    pub(super) kind: ElementType,
    pub(super) data: &'a [u8],
    /// Offset of the element's tag, in bytes, in the file or in the decompressed variable.
    pub(super) offset: usize,
}

/// Reads elements one after the other.
pub(super) struct Cursor<'a, 's> {
    source: &'s FileBytes<'s>,
    bytes: &'a [u8],
    order: Order,
    base: usize,
    at: usize,
}

impl<'a, 's> Cursor<'a, 's> {
    /// A cursor at the start of `bytes`; `base` is the offset of `bytes` in the file.
    pub(super) fn new(source: &'s FileBytes<'s>, bytes: &'a [u8], order: Order, base: usize) -> Self {
        Self { source, bytes, order, base, at: 0 }
    }

    /// The next element; none at the end.
    pub(super) fn next(&mut self) -> Result<Option<Element<'a>>, ReadError> {
        let offset = self.base + self.at;
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        if rest.is_empty() {
            return Ok(None);
        }
        let place = || format!("data element at byte {offset}");
        let (Some(first), Some(second)) = (u32_at(rest, 0, self.order), u32_at(rest, 4, self.order)) else {
            return Err(self.source.cut_short(place(), "bytes", 8, rest.len() as u64));
        };
        let small = first >> 16;
        let (code, size, start) = if small > 0 { (first & 0xffff, small, 4) } else { (first, second, 8) };
        let size = usize::try_from(size).unwrap_or(usize::MAX);
        let Some(data) = rest.get(start..).and_then(|r| r.get(..size)).filter(|_| small <= 4) else {
            let there = rest.len().saturating_sub(start);
            return Err(self.source.cut_short(place(), "bytes", size as u64, there as u64));
        };
        let kind = ElementType::of(code);
        let used = if small > 0 { 8 } else { start + size };
        self.at += if kind == ElementType::Compressed { used } else { used.next_multiple_of(8) };
        Ok(Some(Element { kind, data, offset }))
    }

    /// The next element; an error where there is none.
    pub(super) fn expect(&mut self, what: &str) -> Result<Element<'a>, ReadError> {
        let offset = self.base + self.at;
        self.next()?.ok_or_else(|| self.source.malformed(format!("byte {offset}"), "the end", what))
    }
}
