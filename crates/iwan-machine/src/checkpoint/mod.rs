//! Checkpoints: finished parts of long work are kept on the disk, so that they need not be computed again after a process was killed.

mod digest;
mod pieces;
mod folder;

pub use digest::Digest;
pub use folder::{Checkpoint, CheckpointError};
pub use pieces::State;
