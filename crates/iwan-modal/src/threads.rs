//! The number of threads on which the methods work.

use rayon::ThreadPoolBuilder;
use rayon::prelude::*;

use crate::error::{Error, check};

/// Does `work` on `threads` threads, which end when it is done; the result has the same bits for any number of threads. Where the system
/// gives no thread the calling thread does all of it.
///
/// # Errors
/// [`Error::OutOfRange`] for 0 threads.
///
/// ```
/// assert_eq!(iwan_modal::on_threads(2, || 6 * 7)?, 42);
/// assert!(iwan_modal::on_threads(0, || 0).is_err());
/// # Ok::<(), iwan_modal::Error>(())
/// ```
pub fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> Result<T, Error> {
    let remedy = "ask for fewer threads, 1 at least";
    check("threads", threads as f64, threads > 0, "1 or more", remedy)?;
    if let Ok(pool) = ThreadPoolBuilder::new().num_threads(threads).build() {
        return Ok(pool.install(work));
    }
    // From here on this thread is a pool of its own, in which Rayon starts no other; if it is one already, that is what is needed.
    let alone = ThreadPoolBuilder::new().num_threads(1).use_current_thread().build();
    let result = work();
    drop(alone);
    Ok(result)
}

/// Does `work` on every item, on the threads of [`on_threads`] if called from there; the results are in the order of the items.
///
/// ```
/// assert_eq!(iwan_modal::each_of(&[1, 2, 3], |n| n * n), [1, 4, 9]);
/// ```
pub fn each_of<I: Sync, R: Send>(items: &[I], work: impl Fn(&I) -> R + Send + Sync) -> Vec<R> {
    items.par_iter().map(work).collect()
}
