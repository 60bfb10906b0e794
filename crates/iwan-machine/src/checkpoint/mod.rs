//! Long work that is kept while it is done, so that what was done before a process was killed is not done again.

mod digest;
mod pieces;
mod folder;

pub use digest::Digest;
pub use folder::{Checkpoint, CheckpointError};
pub use pieces::State;
