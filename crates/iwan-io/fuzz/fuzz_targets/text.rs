//! Any bytes as a text file: an error or a valid record, never a panic.
#![no_main]

use iwan_io::{Format, parse_table};
use iwan_io_fuzz::{NAME, read, told};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    read(Format::Text, bytes);
    let _ = told(parse_table(NAME.as_ref(), bytes));
});
