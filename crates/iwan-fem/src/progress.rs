//! How far a long computation is, and whether it is to go on.

use std::ops::ControlFlow;

/// Called with the share done (0 to 1); breaking off ends the computation with
/// [`Error::Interrupted`](crate::Error::Interrupted).
pub type Progress<'a> = &'a mut dyn FnMut(f64) -> ControlFlow<()>;

/// Progress through the part of a piece of work from one share to another.
pub(crate) fn part(
    progress: &mut dyn FnMut(f64) -> ControlFlow<()>,
    [from, to]: [f64; 2],
) -> impl FnMut(f64) -> ControlFlow<()> {
    move |share| progress(from + (to - from) * share)
}
