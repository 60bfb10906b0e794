//! One record, one mode: band-pass, analytic signal, envelope and frequency.
//!
//! [`envelope()`] does it all; [`isolate()`] and [`Isolated::envelope`] do it in two steps, [`opinions`] by all methods.

mod defects;
mod envelope;
mod extrema;
mod filter;
mod hann;
mod hilbert;
mod isolate;
mod peaks;
mod pff;
mod raw;
mod spectrum;
mod spread;

pub use envelope::{Envelope, Method, envelope};
pub use filter::{Butterworth, Passband};
pub use hann::{Spot, spot};
pub use hilbert::{Analytic, analytic_signal, whole_cycles};
pub use isolate::{Isolated, Options, isolate};
pub use spectrum::{Band, amplitude_spectrum, automatic_band};
pub use spread::{Opinions, Spread, opinions};
