//! One record, one mode: band-pass, analytic signal, envelope and frequency.

mod filter;
mod hilbert;

pub use filter::{Butterworth, Passband};
pub use hilbert::{Analytic, analytic_signal, whole_cycles};
