//! Files that appear whole or not at all.
//!
//! Each file is written beside its destination under a temporary name, flushed to the disk, then renamed. Whatever
//! happens before the renaming, an error or a crash, leaves the destination as it was.

mod litter;
mod file;
mod folder;

pub use file::{WriteError, write_file};
pub use folder::Folder;
