//! Any bytes as a wav file: an error or a valid record, never a panic.
#![no_main]

use iwan_io::{Format, ReadOptions, read_bytes};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let options =
        ReadOptions { format: Some(Format::Wav), rate: Some(1.0), resample: true, ..Default::default() };
    if let Ok(record) = read_bytes("fuzz".as_ref(), bytes, &options) {
        assert!(record.len() >= 2 && record.dt() > 0.0);
    }
});
