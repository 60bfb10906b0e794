//! Any bytes as a mat file: an error or a valid record, never a panic.
#![no_main]

use iwan_io::{Format, mat_matrices};
use iwan_io_fuzz::{NAME, read, told};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    read(Format::Mat, bytes);
    let _ = told(mat_matrices(NAME.as_ref(), bytes));
});
