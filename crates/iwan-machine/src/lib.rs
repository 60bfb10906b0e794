//! What the machine gives: memory, threads and whole files, each asked for before it is taken.
//!
//! A computation that asks the operating system for more memory than there is ends in an abort, and takes an interpreter with it; a
//! thread that cannot be had is a panic. Here both are questions with an answer: [`memory::ask`] refuses with a remedy before anything is
//! allocated, and [`threads`] does the work on the threads that there are, one at least. [`read_file`] reads what is a file, and neither
//! waits for ever nor fills the memory over what is none. A [`checkpoint`] keeps what is done of long work, so that a process that is killed is
//! no loss.

// The kinds of error that all crates share: this is the lowest of those that read files.
mod kinds;

// Lists of names in messages.
mod names;

// How much memory is free, and whether an estimate fits.
pub mod memory;

// Work on as many threads as can be had.
pub mod threads;

// The bytes of a file, as far as memory reaches.
mod files;

// Long work that is kept while it is done.
pub mod checkpoint;

pub use files::read_file;
pub use kinds::Kind;
pub use names::{listed, shortened};
