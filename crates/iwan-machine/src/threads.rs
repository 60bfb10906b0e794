//! Work on as many threads as the system gives, the calling thread included: where it gives none, the calling thread does all of it.
//!
//! No result depends on the number of threads: callers divide the work by its size alone.

use std::num::NonZeroUsize;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::thread::Builder;

use crate::address_space::address_space;

/// Address space, bytes, below which work is done on one thread.
const ROOMY: u64 = 4 << 30;

/// Number of threads that may work at once, the one that set it included; no limit by default, so that nested work may begin more threads than
/// there are cores and the system shares them out.
static LIMIT: AtomicUsize = AtomicUsize::new(usize::MAX);
/// Number of threads that were begun here and have not ended.
static BEGUN: AtomicUsize = AtomicUsize::new(0);
/// Number of threads that wait here for others to end.
static WAITING: AtomicUsize = AtomicUsize::new(0);
/// Number of threads that the system runs at once: asking takes as long as a short piece of work, and the answer stays.
static CORES: OnceLock<usize> = OnceLock::new();

/// Lets at most `threads` threads work at once from now on, in whatever depth work begins work; 0 counts as 1.
///
/// ```
/// iwan_machine::threads::limit(1);
/// let name = || std::thread::current().id();
/// assert_eq!(iwan_machine::threads::together(8, &name), [name()]);
/// ```
pub fn limit(threads: usize) {
    LIMIT.store(threads.max(1), Ordering::Relaxed);
}

/// Number of threads that [`limit`] lets work at once; none without a limit.
#[must_use]
pub fn limited() -> Option<usize> {
    Some(LIMIT.load(Ordering::Relaxed)).filter(|threads| *threads < usize::MAX)
}

/// The right to begin one thread more, given back when it ends.
struct Place;

impl Place {
    fn take() -> Option<Self> {
        if is_crowded() {
            return None;
        }
        let most = LIMIT.load(Ordering::Relaxed) - 1;
        let more = |begun: usize| (begun < most).then_some(begun + 1);
        BEGUN.fetch_update(Ordering::Relaxed, Ordering::Relaxed, more).ok().map(|_| Self)
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        BEGUN.fetch_sub(1, Ordering::Relaxed);
    }
}

/// A thread that waits for others, until it goes on.
struct Wait;

impl Wait {
    fn begin() -> Self {
        WAITING.fetch_add(1, Ordering::Relaxed);
        Self
    }
}

impl Drop for Wait {
    fn drop(&mut self) {
        WAITING.fetch_sub(1, Ordering::Relaxed);
    }
}

/// Whether fewer threads work than the system runs at once.
fn has_idle_core() -> bool {
    let (begun, waiting) = (BEGUN.load(Ordering::Relaxed), WAITING.load(Ordering::Relaxed));
    1 + begun < at_once() + waiting
}

/// Whether the calling thread does better alone: a thread that starts without room for its signal stack aborts the process.
fn is_crowded() -> bool {
    address_space() < ROOMY
}

/// Number of threads that the system runs at once, [`limit`] at most; one where it does not say, and where `ulimit -v` leaves less than 4 GB of address space: each
/// thread reserves room for its stack, its share of the allocator and the kernels of dense matrices, hundreds of megabytes that it hardly uses.
///
/// ```
/// assert!(iwan_machine::threads::at_once() >= 1);
/// ```
#[must_use]
pub fn at_once() -> usize {
    if is_crowded() {
        return 1;
    }
    let ask = || std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
    (*CORES.get_or_init(ask)).min(LIMIT.load(Ordering::Relaxed))
}

/// Runs `work` on the calling thread and on up to `threads - 1` others at once, and returns the result of each, that of the calling thread
/// first. `work` takes pieces from a common store until none are left.
///
/// ```
/// use std::sync::atomic::{AtomicU32, Ordering};
/// let pile = AtomicU32::new(100);
/// let take = || (0..).take_while(|_| pile.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |n| n.checked_sub(1)).is_ok()).count();
/// assert_eq!(iwan_machine::threads::together(4, &take).iter().sum::<usize>(), 100);
/// ```
pub fn together<R: Send>(threads: usize, work: &(dyn Fn() -> R + Sync)) -> Vec<R> {
    std::thread::scope(|scope| {
        let helper = |_| {
            let place = Place::take()?;
            let run = move || {
                let _place = place;
                work()
            };
            Builder::new().spawn_scoped(scope, run).ok()
        };
        let helpers: Vec<_> = (1..threads).map_while(helper).collect();
        let mut results = vec![work()];
        let _wait = Wait::begin();
        for helper in helpers {
            match helper.join() {
                Ok(result) => results.push(result),
                Err(panic) => resume_unwind(panic),
            }
        }
        results
    })
}

/// Applies `work` to every item, on at most `threads` threads. The results are in the order of the items, with the same bits whatever the
/// number of threads. Items are begun in their order: put those that take longest first.
///
/// ```
/// assert_eq!(iwan_machine::threads::in_parallel(&[1, 2, 3], 2, &|n| n * n), [1, 4, 9]);
/// ```
pub fn in_parallel<I: Sync, R: Send>(items: &[I], threads: usize, work: &(dyn Fn(&I) -> R + Sync)) -> Vec<R> {
    if threads <= 1 || items.len() <= 1 {
        return items.iter().map(work).collect();
    }
    let next = AtomicUsize::new(0);
    let take = || {
        let taken = std::iter::from_fn(|| {
            let i = next.fetch_add(1, Ordering::Relaxed);
            items.get(i).map(|item| (i, work(item)))
        });
        taken.collect::<Vec<_>>()
    };
    let mut done: Vec<_> = together(threads.min(items.len()), &take).into_iter().flatten().collect();
    done.sort_by_key(|(i, _)| *i);
    done.into_iter().map(|(_, result)| result).collect()
}

/// Runs both, at the same time where the system gives a thread for the second.
///
/// ```
/// assert_eq!(iwan_machine::threads::both(&|| 6 * 7, &|| "x"), (42, "x"));
/// ```
pub fn both<A, B: Send>(first: &dyn Fn() -> A, second: &(dyn Fn() -> B + Sync)) -> (A, B) {
    let Some(place) = Place::take() else { return (first(), second()) };
    std::thread::scope(|scope| {
        let run = move || {
            let _place = place;
            second()
        };
        let Ok(other) = Builder::new().spawn_scoped(scope, run) else { return (first(), second()) };
        let first = first();
        let _wait = Wait::begin();
        match other.join() {
            Ok(second) => (first, second),
            Err(panic) => resume_unwind(panic),
        }
    })
}

/// Runs both, at the same time where a core has nothing to do: for pieces of a millisecond that are done again and again by work that may itself be one of many in
/// parallel. What has not begun on the other core when the first is done is taken back.
///
/// ```
/// let (mut a, mut b) = (0, 0);
/// iwan_machine::threads::both_where_idle(|| a += 1, || b += 2);
/// assert_eq!((a, b), (1, 2));
/// ```
pub fn both_where_idle<A, B: Send>(first: impl FnOnce() -> A, second: impl FnOnce() -> B + Send) -> (A, B) {
    if !has_idle_core() {
        return (first(), second());
    }
    let kept = Mutex::new(Some(second));
    let take = || {
        let second = kept.lock().unwrap_or_else(PoisonError::into_inner).take();
        second.map(|second| second())
    };
    std::thread::scope(|scope| {
        let helper = Place::take().and_then(|place| {
            let run = move || {
                let _place = place;
                take()
            };
            Builder::new().spawn_scoped(scope, run).ok()
        });
        let first = first();
        let taken_back = take();
        let _wait = Wait::begin();
        let helped = helper.and_then(|helper| helper.join().unwrap_or_else(|panic| resume_unwind(panic)));
        match taken_back.or(helped) {
            Some(second) => (first, second),
            // One of the two has taken it.
            None => unreachable!("the second piece of work was done by nobody"),
        }
    })
}

/// Starts `work` on a thread of its own, or returns `work` where the system gives no thread.
///
/// # Errors
/// Returns `work` itself.
///
/// ```
/// let (sender, receiver) = std::sync::mpsc::channel();
/// let begun = iwan_machine::threads::begin("sum", move || sender.send(40 + 2).unwrap_or_default());
/// if let Err(work) = begun {
///     work();
/// }
/// assert_eq!(receiver.recv(), Ok(42));
/// ```
pub fn begin<F: FnOnce() + Send + 'static>(name: &str, work: F) -> Result<(), F> {
    fn take<F>(kept: &Mutex<Option<F>>) -> Option<F> {
        kept.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
    let kept = Arc::new(Mutex::new(Some(work)));
    let passed = Arc::clone(&kept);
    let run = move || {
        if let Some(work) = take(&passed) {
            work();
        }
    };
    match Builder::new().name(name.into()).spawn(run) {
        Ok(_) => Ok(()),
        // A thread that did not start has not taken the work.
        Err(_) => take(&kept).map_or(Ok(()), Err),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::time::Duration;

    use super::{LIMIT, both, both_where_idle, in_parallel, limit};

    /// Work within work began threads without end: a fit with `--threads 1` kept all cores busy.
    #[test]
    fn no_more_threads_work_than_are_allowed() {
        let (working, most) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let work = |_: &u32| {
            most.fetch_max(working.fetch_add(1, Ordering::SeqCst) + 1, Ordering::SeqCst);
            std::thread::sleep(Duration::from_millis(2));
            working.fetch_sub(1, Ordering::SeqCst);
        };
        let items = [0_u32; 6];
        let all = || in_parallel(&items, 6, &work);
        let inner = |_: &u32| both(&all, &|| both_where_idle(all, all));
        for threads in [1, 2, 3] {
            limit(threads);
            most.store(0, Ordering::SeqCst);
            in_parallel(&items[..3], 3, &inner);
            // Other tests of this program may hold places, too.
            let most = most.load(Ordering::SeqCst);
            assert!((1..=threads).contains(&most), "{most} of {threads}");
        }
        LIMIT.store(usize::MAX, Ordering::Relaxed);
        in_parallel(&items[..3], 3, &inner);
        assert!(most.load(Ordering::SeqCst) > 3);
    }

    /// Whoever does the second piece, it is done once, also where the first is done before another thread begins.
    #[test]
    fn both_pieces_are_done_once() {
        let done = AtomicUsize::new(0);
        let piece = |n: usize| {
            std::thread::sleep(Duration::from_micros(10 * (n % 7) as u64));
            done.fetch_add(1, Ordering::SeqCst);
            n * n
        };
        for n in 0..200 {
            assert_eq!(both_where_idle(|| piece(n), || piece(n + 1)), (n * n, (n + 1) * (n + 1)));
        }
        assert_eq!(done.load(Ordering::SeqCst), 400);
    }

    #[test]
    fn the_order_stays_whatever_the_threads() {
        let items: Vec<u32> = (0..100).collect();
        for threads in [1, 2, 7] {
            let squares = in_parallel(&items, threads, &|n| n * n);
            assert!(squares.iter().zip(&items).all(|(s, n)| *s == n * n), "{threads}");
        }
        assert!(in_parallel::<u32, u32>(&[], 4, &|n| *n).is_empty());
    }
}
