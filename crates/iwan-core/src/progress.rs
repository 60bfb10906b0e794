//! Progress of long work, and the word to stop it.

use core::ops::ControlFlow;

/// What long work calls from time to time with the share done, from 0 to 1; `Break` asks it to stop.
///
/// It is a shared reference that any thread may call, because whoever listens is shared anyway: a bar on a
/// terminal, a number that another thread shows, a flag that Ctrl-C sets. So work on many threads and work on one
/// take the same thing, and since it is `Copy`, work hands it on to its parts as it is, or as a [`part`]. How soon
/// a `Break` is heard, and which error tells of it, is said where the work is described.
///
/// ```
/// use core::ops::ControlFlow;
/// use core::sync::atomic::{AtomicUsize, Ordering};
/// use iwan_core::progress::{Progress, part};
///
/// fn count(to: u32, progress: Progress<'_>) -> Option<u32> {
///     (1..=to).find(|n| progress(f64::from(*n) / f64::from(to)).is_break())
/// }
///
/// let percent = AtomicUsize::new(0);
/// let listener = |share: f64| {
///     percent.store((100.0 * share) as usize, Ordering::Relaxed);
///     if share > 0.7 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
/// };
/// assert_eq!(count(10, &part(&listener, [0.0, 0.5])), None); // the first half of the work
/// assert_eq!(percent.load(Ordering::Relaxed), 50);
/// assert_eq!(count(10, &part(&listener, [0.5, 1.0])), Some(5)); // stopped in the second, at 75 %
/// ```
pub type Progress<'a> = &'a (dyn Fn(f64) -> ControlFlow<()> + Sync);

/// Nobody listens, and nobody stops the work.
pub const UNWATCHED: Progress<'static> = &|_| ControlFlow::Continue(());

/// Progress through the part of a piece of work between two shares of the whole.
pub fn part(progress: Progress<'_>, [from, to]: [f64; 2]) -> impl Fn(f64) -> ControlFlow<()> + Sync {
    move |share| progress(from + (to - from) * share)
}
