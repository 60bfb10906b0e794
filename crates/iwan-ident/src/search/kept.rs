//! Ends of searches that are kept in a checkpoint.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use iwan_machine::checkpoint::Checkpoint;

/// A checkpoint, and the flag that stops the searches which it keeps.
#[derive(Debug, Clone)]
pub(crate) struct Kept {
    pub(crate) checkpoint: Arc<Checkpoint>,
    pub(crate) stopped: Arc<AtomicBool>,
}

/// The end of a search, as it is kept in a checkpoint.
pub(super) struct End {
    pub(super) x: Vec<f64>,
    pub(super) cost: f64,
    pub(super) converged: bool,
}

impl Kept {
    /// The end of a search that an earlier run has done; none where there is none.
    pub(super) fn end(&self, key: u128) -> Option<End> {
        let found = self.checkpoint.noted(key)?;
        let [cost, converged, x @ ..] = found.as_slice() else { return None };
        Some(End { x: x.to_vec(), cost: *cost, converged: *converged != 0.0 })
    }

    /// Keeps the end of a search, unless the search was stopped.
    pub(super) fn keep(&self, key: u128, (x, cost, converged): (&[f64], f64, bool)) {
        if !self.stopped.load(Ordering::Relaxed) {
            self.checkpoint.note(key, &[&[cost, f64::from(u8::from(converged))], x].concat());
        }
    }
}
