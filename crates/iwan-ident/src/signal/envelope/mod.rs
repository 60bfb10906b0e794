//! Amplitude and frequency of an isolated mode against time, by four methods, and how far these disagree.

mod traces;
mod residuals;
mod peaks;
mod peak_fitting;
mod demodulation;
mod instantaneous;
mod by_method;
mod opinions;

pub use by_method::envelope;
pub use instantaneous::{Envelope, Instant, Method};
pub use opinions::{Opinions, Refusal, Spread, opinions};
