//! Any bytes as a npz file: an error or a valid record, never a panic.
#![no_main]

use iwan_io::{Format, numpy_members};
use iwan_io_fuzz::{NAME, read, told};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    read(Format::Npz, bytes);
    let _ = told(numpy_members(NAME.as_ref(), bytes));
});
