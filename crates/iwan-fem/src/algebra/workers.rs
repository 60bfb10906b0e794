//! Threads for large dense work, with the same bits for any number of threads.
//!
//! How work is divided depends on its size alone, and no sum is divided: each entry of a product is summed by one thread, in the order in
//! which a single thread would sum it. The threads end with the work, so that no process forks while threads of a pool exist.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, Par};
use iwan_machine::memory::{ask_for_kernels, is_address_space_bounded};
use iwan_machine::threads::{at_once, limited};

use crate::error::Error;

/// Number of entries of a factor above which threads save more time than their start takes: the paper's beam has 0.35 million, a cube of
/// 10,000 unknowns about 4 million. The gain above depends on the load of the other cores; the bits do not depend on it.
const LARGE: usize = 4_000_000;
/// Number of parts into which dense work is divided, for any number of threads: with more cores than this some are idle.
const PARTS: usize = 8;

/// A pool of threads, or none for small work.
pub(crate) struct Workers {
    pool: Option<rayon::ThreadPool>,
}

/// Makes the kernels reserve their address space on this thread now, by a product that is just large enough for them. Whoever asks for memory
/// afterwards is told what is left; otherwise a factor that seemed to fit aborted the process when the kernels came to their share.
fn reserve() {
    let a = Mat::<f64>::identity(64, 64);
    let mut product = Mat::<f64>::zeros(64, 64);
    matmul(&mut product, Accum::Replace, &a, &a, 1.0, Par::Seq);
}

impl Workers {
    /// The threads for work with a factor of this many entries: as many as [`limited`] says, or as RAYON_NUM_THREADS says, or as there are
    /// cores.
    ///
    /// # Errors
    /// An error if there is too little address space for what the kernels reserve on each thread.
    pub(crate) fn for_entries(entries: usize) -> Result<Self, Error> {
        // Where address space is scarce there is no room for the kernels of several threads.
        let many = entries >= LARGE && at_once() > 1;
        let pool = many.then(|| rayon::ThreadPoolBuilder::new().num_threads(limited().unwrap_or(0)).build());
        // 0 threads stand for the number of the environment or of the cores. If no thread can be created, the work is done on the calling thread.
        let pool = pool.and_then(Result::ok);
        ask_for_kernels(pool.as_ref().map_or(0, rayon::ThreadPool::current_num_threads))?;
        if is_address_space_bounded() {
            match &pool {
                Some(pool) => drop(pool.broadcast(|_| reserve())),
                None => reserve(),
            }
        }
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

    /// Runs `work`; its argument says how it may be divided.
    pub(crate) fn run<R: Send>(&self, work: impl FnOnce(Par) -> R + Send) -> R {
        match &self.pool {
            Some(pool) => pool.install(|| work(Par::rayon(PARTS))),
            None => work(Par::Seq),
        }
    }

    /// Runs two functions, at the same time if there are threads.
    pub(crate) fn both(&self, first: impl FnOnce() + Send, second: impl FnOnce() + Send) {
        if let Some(pool) = &self.pool {
            pool.join(first, second);
        } else {
            first();
            second();
        }
    }
}
