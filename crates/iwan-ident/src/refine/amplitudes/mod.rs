//! Complex amplitudes in windows, of a record and of a model's ring-down: slow decays by a table of half cycles, white noise made white again, and the phase that the
//! frequency of a day adds.

pub(super) mod slow;
pub(super) mod windows;
mod decay;
pub(super) mod whitening;
pub(super) mod days;
