//! Complex amplitudes in windows, of a record and of a model's ring-down: the windows, slow decays by a table of half cycles, amplitudes whose white
//! noise is made white again, and the phase that the frequency of a day adds.

mod tabled;
mod strides;
pub(super) mod slow;
pub(super) mod windows;
mod decay;
pub(super) mod whitening;
pub(super) mod days;
