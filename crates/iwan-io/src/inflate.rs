//! Decompression that cannot run away.

use std::io::{self, Read};

/// No deflate stream grows by more than this factor (RFC 1951: 258 bytes from two bits at best).
const MOST_GROWTH: u64 = 1032;

/// Reads to the end, but no more than deflate can make of `compressed` bytes.
pub(crate) fn read_limited(reader: &mut impl Read, compressed: usize) -> io::Result<Vec<u8>> {
    let most = (compressed as u64).saturating_add(64).saturating_mul(MOST_GROWTH);
    let mut bytes = Vec::new();
    reader.take(most.saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        return Err(io::Error::other(format!("more than {most} bytes from {compressed} compressed ones")));
    }
    Ok(bytes)
}
