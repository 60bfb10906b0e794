//! Any bytes as a lvm file: an error or a valid record, never a panic.
#![no_main]

use iwan_io::Format;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| iwan_io_fuzz::read(Format::Lvm, bytes));
