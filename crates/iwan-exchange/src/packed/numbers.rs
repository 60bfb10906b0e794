//! Numbers of all stored types, and compressed bytes that cannot run away.
#![allow(clippy::cast_possible_wrap, reason = "the sign of stored integers is the top bit")]

use std::io::{self, Read};

/// A stored type of numbers, in either byte order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Kind {
    /// Bytes of one number: 1, 2, 4 or 8.
    pub(super) size: usize,
    pub(super) class: Class,
    pub(super) big: bool,
}

/// How the bytes of a number are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Class {
    Float,
    Signed,
    Unsigned,
}

impl Kind {
    /// Number `at` of some bytes; none beyond their end. Integers above 2^53 are rounded.
    pub(super) fn at(self, bytes: &[u8], at: usize) -> Option<f64> {
        let chunk = bytes.get(at.checked_mul(self.size)?..)?.get(..self.size)?;
        let mut raw = [0_u8; 8];
        for (k, byte) in chunk.iter().enumerate() {
            raw[if self.big { self.size - 1 - k } else { k }] = *byte;
        }
        let bits = u64::from_le_bytes(raw);
        Some(match (self.class, self.size) {
            (Class::Float, 4) => f64::from(f32::from_bits(bits as u32)),
            (Class::Float, _) => f64::from_bits(bits),
            (Class::Unsigned, _) => bits as f64,
            (Class::Signed, size) => {
                let shift = 64 - 8 * size as u32;
                (((bits << shift) as i64) >> shift) as f64
            }
        })
    }

    /// How many numbers the bytes hold.
    pub(super) fn count(self, bytes: &[u8]) -> usize {
        bytes.len() / self.size
    }
}

/// No deflate stream grows by more than this factor (RFC 1951: 258 bytes from two bits at best). A stream that would is none.
const MOST_GROWTH: u64 = 1032;
/// Bytes granted beyond the stream's own: the bound holds without them.
const GRANTED: u64 = 64;

/// Growth beyond [`FREE`]: indices of a stiffness shrink to no less than a hundredth.
const SENSIBLE_GROWTH: u64 = 100;
/// Up to so many bytes an archive may grow as deflate can.
const FREE: u64 = 64 << 20;
/// Bytes unpacked between two looks at the memory that is left.
const PIECE: u64 = 16 << 20;

/// Reads to the end what `compressed` bytes may have become at most.
pub(super) fn inflate(reader: &mut impl Read, compressed: usize) -> io::Result<Vec<u8>> {
    let deflate = (compressed as u64).saturating_add(GRANTED).saturating_mul(MOST_GROWTH);
    let most = deflate.min((compressed as u64).saturating_mul(SENSIBLE_GROWTH).max(FREE));
    let mut bytes = Vec::new();
    while reader.take(PIECE.min(most + 1 - bytes.len() as u64)).read_to_end(&mut bytes)? as u64 == PIECE {
        let remedy = "free some, or give a smaller file";
        iwan_machine::memory::ask("what it unpacks to", 4 * bytes.len() as u64, remedy)
            .map_err(|short| io::Error::new(io::ErrorKind::OutOfMemory, short))?;
    }
    if bytes.len() as u64 > most {
        return Err(io::Error::other(format!("more than {most} bytes after decompression")));
    }
    Ok(bytes)
}
