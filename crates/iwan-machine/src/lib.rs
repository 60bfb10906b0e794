//! Resources of the machine: memory, threads and whole files, each asked for before it is taken.
//!
//! A computation that asks the operating system for more memory than there is ends in an abort, and ends a Python interpreter with it; a
//! thread that the system cannot start is a panic. Here both are requests that can be refused: [`memory::ask`] refuses with a remedy before anything is
//! allocated, and [`threads`] does the work on as many threads as the system gives, at least the calling one. [`read_file`] reads files, and neither
//! waits for ever nor fills the memory where the path is no file. A [`checkpoint`] keeps finished parts of long work, so that little
//! is lost when a process is killed.

// The kinds of error that all crates share: this crate is the lowest of those that read files.
mod kinds;

// Names in messages: lists of them, long ones, and those with characters that do harm.
mod names;

// Messages as they may be shown: of bounded length, and without characters that a terminal obeys.
mod messages;

// Address space, of which threads and memory both take.
mod address_space;

// Work on as many threads as can be had.
pub mod threads;

// How much memory is free, and whether an estimate fits.
pub mod memory;

// The bytes of a file, as far as there is memory for them.
mod files;

// Checkpoints: parts of long work are kept on the disk as they are done.
pub mod checkpoint;

pub use files::{lacking, read_file, read_file_within};
pub use kinds::Kind;
pub use messages::{brief, coded, harmless, without_long_numbers};
pub use names::{is_harmful, listed, plain, shortened};
