//! How far a study is, and whether it is to continue.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};

use iwan_core::Progress;

use crate::error::Error;

/// Counts the pieces of work that are done, and reports to the observer.
pub(crate) struct Tally<'a> {
    observer: Progress<'a>,
    pieces: usize,
    done: AtomicUsize,
}

impl<'a> Tally<'a> {
    /// A tally for this number of pieces.
    pub(crate) const fn new(observer: Progress<'a>, pieces: usize) -> Self {
        Self { observer, pieces, done: AtomicUsize::new(0) }
    }

    /// Reports the work done; `part` is the progress of the piece under way, 0 to 1.
    pub(crate) fn under_way(&self, part: f64) -> ControlFlow<()> {
        (self.observer)((self.done.load(Ordering::Relaxed) as f64 + part) / self.pieces as f64)
    }

    /// Counts further pieces as done.
    pub(crate) fn add(&self, pieces: usize) -> Result<(), Error> {
        self.done.fetch_add(pieces, Ordering::Relaxed);
        if self.under_way(0.0).is_break() { Err(Error::Interrupted) } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use super::*;

    #[test]
    fn shares_grow_with_the_pieces_and_a_break_is_an_interruption() {
        let heard = Mutex::new(Vec::new());
        let observer = |share: f64| {
            heard.lock().unwrap().push(share);
            if share > 0.9 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let tally = Tally::new(&observer, 4);
        assert!(tally.under_way(0.5).is_continue());
        assert_eq!(tally.add(3), Ok(()));
        assert_eq!(tally.add(1), Err(Error::Interrupted));
        assert_eq!(*heard.lock().unwrap(), [0.125, 0.75, 1.0]);
    }
}
