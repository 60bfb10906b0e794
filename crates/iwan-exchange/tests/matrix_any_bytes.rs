//! No bytes make a reader panic or ask for more memory than it says, and what it accepts is a sound matrix.
#![allow(clippy::unwrap_used)]

use crate::common::files;
use iwan_exchange::{Format, read_bytes};
use proptest::prelude::*;
use std::path::Path;

/// What [`iwan_exchange::read`] says about its memory; compressed files are measured by what they hold.
const BYTES_PER_BYTE: u64 = 64;
const BYTES_AT_LEAST: u64 = 64 << 10;
/// No stream of deflate grows by more.
const GROWTH: u64 = 1032;

fn check(name: &str, bytes: &[u8], format: Option<Format>) {
    let mut outcome = None;
    let memory = allocation_counter::measure(|| outcome = Some(read_bytes(Path::new(name), bytes, format)));
    let compressed = name.ends_with("npz") || name.ends_with("mat") || bytes.starts_with(b"PK");
    let grown = if compressed { GROWTH } else { 1 };
    let allowed = BYTES_PER_BYTE * grown * bytes.len() as u64 + BYTES_AT_LEAST;
    assert!(memory.bytes_max <= allowed, "{name}: {} bytes for a file of {}", memory.bytes_max, bytes.len());
    match outcome.unwrap() {
        Ok(matrices) => {
            for matrix in matrices {
                let inside = |e: &(u32, u32, f64)| {
                    (e.0 as usize) < matrix.rows && (e.1 as usize) < matrix.columns && e.2.is_finite()
                };
                assert!(matrix.entries.iter().all(inside), "{name}");
                assert!(matrix.labels.is_none_or(|labels| labels.len() == matrix.rows), "{name}");
            }
        }
        Err(error) => {
            let text = error.to_string();
            assert!(text.starts_with(name) && text.len() < 2000, "{text}");
        }
    }
}

#[test]
fn every_truncation_is_survived() {
    for (name, bytes) in files() {
        for length in 0..bytes.len() {
            check(&name, &bytes[..length], None);
        }
    }
}

#[test]
fn every_byte_set_to_an_extreme_is_survived() {
    for (name, bytes) in files() {
        for at in 0..bytes.len() {
            for value in [0, 0x20, 0x7f, 0x80, 0xff, b'9', b'-', b'D'] {
                let mut changed = bytes.clone();
                changed[at] = value;
                check(&name, &changed, None);
            }
        }
    }
}

proptest! {
    #[test]
    fn mutations_are_survived(seed in 0_usize..50, changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8)) {
        let (name, mut bytes) = files().swap_remove(seed);
        for (at, value) in changes {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        check(&name, &bytes, None);
    }

    #[test]
    fn noise_is_survived(format in 0..Format::ALL.len(), bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        check("noise", &bytes, Some(Format::ALL[format].1));
    }

    #[test]
    fn words_in_any_order_are_survived(format in 0..Format::ALL.len(), words in prop::collection::vec(prop::sample::select(WORDS), 0..60)) {
        check("words", words.concat().as_bytes(), Some(Format::ALL[format].1));
    }
}

const WORDS: &[&str] = &[
    "%%MatrixMarket matrix coordinate real symmetric\n",
    "%%MatrixMarket matrix array real general\n",
    "1 1 1.0\n",
    "2 1 3\n",
    "99999999999 1 1\n",
    "DMIG    K              0       6       2       0\n",
    "DMIG*   K                              1               1\n",
    "*                      1               1 1.0D+00\n",
    "DMIG,K,1,1,,2,3,1.0\n",
    "       7       7       6       2KAA     1P,3E24.16\n",
    "       1       1       3\n",
    "       1       0       9\n",
    "  131073\n",
    " 1.0 2.0 3.0\n",
    "4294967295 ",
    "-1 ",
    "\n",
    ",",
    "*USER ELEMENT, NODES=2\n",
    "*USER ELEMENT, NODES=4000000000\n",
    "1, 2, 3\n",
    "*MATRIX, TYPE=STIFFNESS\n",
    "** 1, 2\n",
    "NumRows = 7;\n",
    "a=[\n",
    "];\n",
    "x(1) = 1;\n",
    "x(4000000000) = 1;\n",
    "Lower Triangular\n",
    "1,1, 1,1, 5.0\n",
];
