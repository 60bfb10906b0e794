//! Progress of long work, and how the listener stops the work.

use core::ops::ControlFlow;

/// The listener that long work calls from time to time with the share done, from 0 to 1; a listener that returns `Break` asks the work to
/// stop.
///
/// A listener is a shared reference that any thread may call, because several threads need it in any case: a bar on a terminal, a number
/// that another thread shows, a flag that Ctrl-C sets. So work on one thread and work on many threads take the same type. The reference is
/// `Copy`, so work passes it on to its parts unchanged, or as a [`part`]. How soon the work reacts to `Break`, and which error it then
/// returns, stands in the documentation of the work.
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

/// A listener that ignores the progress and never stops the work.
pub const UNWATCHED: Progress<'static> = &|_| ControlFlow::Continue(());

/// Progress of a part of the work: the part's own share 0 to 1 is told as a share between `from` and `to` of the whole work.
pub fn part(progress: Progress<'_>, [from, to]: [f64; 2]) -> impl Fn(f64) -> ControlFlow<()> + Sync {
    move |share| progress(from + (to - from) * share)
}
