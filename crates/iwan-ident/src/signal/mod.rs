//! One record, one mode: band-pass, analytic signal, envelope and frequency.
//!
//! [`envelope()`] does it all; [`isolate()`] and [`Isolated::envelope`] do it in two steps, [`opinions`] by all methods.

mod filter;
mod hilbert;
mod spectrum;
mod spot;
mod extrema;
mod defects;
mod first_peak;
mod survey;
mod raw;
mod transients;
mod isolated;
mod in_band;
mod strangers;
mod beside;
mod isolate;
mod envelope;

pub(crate) use defects::sample_noise;
pub use envelope::{Envelope, Instant, Method, Opinions, Refusal, Spread, envelope, opinions};
pub use filter::{Butterworth, Passband};
pub use hilbert::{Analytic, analytic_signal, whole_cycles};
pub use in_band::Options;
pub(crate) use in_band::taken_as;
pub use isolate::isolate;
pub(crate) use isolated::HARDLY;
pub use isolated::Isolated;
pub use spectrum::{
    Band, SpectralLine, amplitude_spectrum, automatic_band, half_power_width, is_peak, vertex,
};
pub use spot::{Spot, spot};
pub use strangers::Intruder;
pub use survey::{
    Event, Hit, Overview, SpectralPeak, Spectrogram, Treatment, band_near, events, hits, overview,
    spectral_peaks, spectrogram, treatment,
};
