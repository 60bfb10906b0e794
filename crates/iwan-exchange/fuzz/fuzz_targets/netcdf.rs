//! Any bytes as a file of the format.
#![no_main]

use iwan_exchange::Format;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| iwan_exchange_fuzz::read("fuzz.nc", Format::Netcdf, bytes));
