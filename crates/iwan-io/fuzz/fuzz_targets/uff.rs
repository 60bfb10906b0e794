//! Any bytes as a uff file: an error or a valid record, never a panic.
#![no_main]

use iwan_io::{Format, uff_functions, uff_model};
use iwan_io_fuzz::{NAME, read, told};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    read(Format::Uff, bytes);
    let _ = told(uff_functions(NAME.as_ref(), bytes));
    let _ = told(uff_model(NAME.as_ref(), bytes)).map(|model| model.edges());
});
