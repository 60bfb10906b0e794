//! Threads for large dense work: the same bits whatever their number.
//!
//! How work is cut depends on its size alone, and no sum is cut: each entry of a product is summed by one thread, in the
//! order in which a single thread would. The threads end with the work: none is left behind for a fork to lose.

use faer::Par;
use iwan_machine::memory::ask_for_kernels;

use crate::error::Error;

/// Entries of a factor from which on threads are worth their start: the paper's beam has 0.35 million, a cube of 10,000 unknowns
/// about 4 million. How much threads gain above depends on what else the cores do; the bits do not depend on them.
const LARGE: usize = 4_000_000;
/// Parts that dense work is cut into, whatever the number of threads: with more cores than this some stand idle.
const PARTS: usize = 8;

/// Threads, or none.
pub(crate) struct Workers {
    pool: Option<rayon::ThreadPool>,
}

impl Workers {
    /// For work with a factor of so many entries; as many threads as there are cores, or as RAYON_NUM_THREADS says.
    ///
    /// # Errors
    /// Too little address space for what the kernels reserve on each thread.
    pub(crate) fn for_entries(entries: usize) -> Result<Self, Error> {
        let pool = (entries >= LARGE).then(|| rayon::ThreadPoolBuilder::new().build());
        // Where no thread can be had, the work is done without.
        let pool = pool.and_then(Result::ok);
        ask_for_kernels(pool.as_ref().map_or(0, rayon::ThreadPool::current_num_threads))?;
        Ok(Self { pool })
    }

    #[cfg(test)]
    pub(crate) fn none() -> Self {
        Self { pool: None }
    }

    #[cfg(test)]
    pub(crate) fn of(threads: usize) -> Self {
        Self { pool: rayon::ThreadPoolBuilder::new().num_threads(threads).build().ok() }
    }

    #[cfg(test)]
    pub(crate) fn are_threads(&self) -> bool {
        self.pool.is_some()
    }

    /// Does work, which may be cut as the argument says.
    pub(crate) fn run<R: Send>(&self, work: impl FnOnce(Par) -> R + Send) -> R {
        match &self.pool {
            Some(pool) => pool.install(|| work(Par::rayon(PARTS))),
            None => work(Par::Seq),
        }
    }

    /// Does two things, at the same time where there are threads.
    pub(crate) fn both(&self, first: impl FnOnce() + Send, second: impl FnOnce() + Send) {
        if let Some(pool) = &self.pool {
            pool.join(first, second);
        } else {
            first();
            second();
        }
    }
}
