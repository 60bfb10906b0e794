//! Any bytes as a Gmsh file: an error or a sound mesh, never a panic.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| iwan_fem_fuzz::read("fuzz.msh", bytes));
