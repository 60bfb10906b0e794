//! Decompression that cannot run away.

use std::io::{self, Read};

/// No deflate stream grows by more than this factor (RFC 1951: 258 bytes from two bits at best). A stream that would is
/// none, and is refused.
const MOST_GROWTH: u64 = 1032;
/// Bytes granted beyond the stream's own. The bound holds without them; the 66 kB that they stand for are no danger.
const GRANTED: u64 = 64;

/// The bytes that deflate can make of `compressed` bytes at most.
pub(crate) fn most(compressed: usize) -> u64 {
    (compressed as u64).saturating_add(GRANTED).saturating_mul(MOST_GROWTH)
}

/// Reads to the end, but no more than `most` bytes.
pub(crate) fn read_limited(reader: &mut impl Read, most: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    reader.take(most.saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        return Err(io::Error::other(format!("more than {most} bytes after decompression")));
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_endless_stream_is_stopped() {
        assert!(read_limited(&mut io::repeat(7), most(1)).is_err());
        assert_eq!(read_limited(&mut &[1, 2][..], 2).unwrap(), [1, 2]);
    }
}
