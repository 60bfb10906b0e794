//! All tests of iwan-io in one program: linked once, and run side by side.

mod common;

mod any_bytes;
mod binary_files;
mod instrument_files;
mod matlab_files;
mod records;
mod tables;
mod text_files;
mod universal_files;
