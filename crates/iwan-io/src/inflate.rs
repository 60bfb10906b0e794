//! Decompression that is bounded in size and memory.

use crate::error::ReadError;
use crate::file_bytes::FileBytes;
use std::io::{self, ErrorKind, Read};

/// Largest ratio of bytes unpacked to bytes packed that deflate can reach (RFC 1951: 258 bytes from two bits at best). A stream that yields
/// more is no deflate stream, and is refused.
const MOST_GROWTH: u64 = 1032;
/// Packed bytes added to a stream's own before the bound is computed. The bound holds without them; they allow 66 kB more, which is no
/// danger.
const GRANTED: u64 = 64;
/// Largest growth that is allowed above [`FREE`] bytes: a record with noise is packed to no less than a fiftieth of its size, so a file
/// that grows by more repeats one number again and again, or was made to fill a memory.
const SENSIBLE_GROWTH: u64 = 100;
/// Up to this size in bytes (64 MiB) an archive may grow by [`MOST_GROWTH`]: eight million zeros are no danger to any machine.
const FREE: u64 = 64 << 20;
/// Bytes that are unpacked between two checks of the free memory.
const PIECE: u64 = 16 << 20;

/// Largest number of bytes that `compressed` bytes may unpack to.
pub(crate) fn most(compressed: usize) -> u64 {
    let compressed = compressed as u64;
    let deflate = compressed.saturating_add(GRANTED).saturating_mul(MOST_GROWTH);
    deflate.min(compressed.saturating_mul(SENSIBLE_GROWTH).max(FREE))
}

/// Reads to the end, but no more than `most` bytes, and no more than the free memory holds; beyond either limit it returns an error.
pub(crate) fn read_limited(reader: &mut impl Read, most: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    loop {
        let left = most.saturating_add(1).saturating_sub(bytes.len() as u64).min(PIECE);
        let read = reader.take(left).read_to_end(&mut bytes)?;
        if bytes.len() as u64 > most {
            let times = format!("a growth of more than {SENSIBLE_GROWTH} times and {} MB", FREE >> 20);
            return Err(io::Error::other(format!("more than {most} bytes after decompression, {times}")));
        }
        if (read as u64) < PIECE {
            return Ok(bytes);
        }
        // A vector that grows allocates twice its size, and afterwards its bytes are converted to numbers: hence four times the bytes read.
        let remedy = "free some, or give a file of fewer samples";
        iwan_machine::memory::ask("what it unpacks to", 4 * bytes.len() as u64, remedy)
            .map_err(|short| io::Error::new(ErrorKind::OutOfMemory, short))?;
    }
}

/// The error of something that could not be unpacked.
pub(crate) fn refused(source: &FileBytes, place: &str, error: io::Error, expected: &str) -> ReadError {
    match error.kind() {
        ErrorKind::OutOfMemory => ReadError::Io { file: source.file.into(), source: error },
        _ => source.malformed(place, error.to_string(), expected),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_endless_stream_is_stopped() {
        assert!(read_limited(&mut io::repeat(7), most(1)).is_err());
        assert_eq!(read_limited(&mut &[1, 2][..], 2).unwrap(), [1, 2]);
    }

    /// Archives of 9.7 MB unpacked to 15 GB before they were refused.
    #[test]
    fn growth_is_bounded_by_the_file() {
        assert_eq!(most(10), 74 * 1032);
        assert_eq!(most(200_000), 64 << 20);
        assert_eq!(most(9_700_000), 970_000_000);
        assert_eq!(read_limited(&mut io::repeat(0).take(40 << 20), most(200_000)).unwrap().len(), 40 << 20);
    }
}
