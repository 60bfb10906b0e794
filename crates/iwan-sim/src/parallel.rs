//! Independent pieces of work on several threads.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// `work` on every item, on at most `threads` threads; the results are in the order of the items, the same bits whatever the
/// number of threads. Items are begun in their order: give the longest work first.
///
/// ```
/// assert_eq!(iwan_sim::in_parallel(&[1, 2, 3], 2, &|n| n * n), [1, 4, 9]);
/// ```
pub fn in_parallel<I: Sync, R: Send>(items: &[I], threads: usize, work: &(dyn Fn(&I) -> R + Sync)) -> Vec<R> {
    if threads <= 1 || items.len() <= 1 {
        return items.iter().map(work).collect();
    }
    let (next, done) = (AtomicUsize::new(0), Mutex::new(Vec::with_capacity(items.len())));
    std::thread::scope(|scope| {
        for _ in 0..threads.min(items.len()) {
            scope.spawn(|| {
                while let Some((i, item)) = pick(items, &next) {
                    let result = work(item);
                    done.lock().unwrap_or_else(std::sync::PoisonError::into_inner).push((i, result));
                }
            });
        }
    });
    let mut done = done.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    done.sort_by_key(|(i, _)| *i);
    done.into_iter().map(|(_, result)| result).collect()
}

fn pick<'a, I>(items: &'a [I], next: &AtomicUsize) -> Option<(usize, &'a I)> {
    let i = next.fetch_add(1, Ordering::Relaxed);
    items.get(i).map(|item| (i, item))
}

#[cfg(test)]
mod tests {
    use super::*;

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
