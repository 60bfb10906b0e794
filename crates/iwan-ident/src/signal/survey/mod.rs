//! What a record holds before one mode is taken out of it: peaks of its spectrum, hits, defects, and its spectrum over time.

mod ring;
mod peak_list;
mod swing;
mod hits;
mod breaks;
mod events;
mod overview;
mod spectrogram;
mod tapered;
mod skirts;
mod fading;
mod treated;

pub use events::{Event, events};
pub use hits::{Hit, hits};
pub use overview::{Overview, overview};
pub(super) use peak_list::band_among;
pub use peak_list::{SpectralPeak, band_near, spectral_peaks};
pub use spectrogram::{Spectrogram, spectrogram};
pub(super) use swing::slow_rises;
pub use treated::{Treatment, treatment};
