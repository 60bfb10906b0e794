//! What an analyser or a program did to a record before it was given here: a filter, seen by its skirts beside the mode, or a window, seen by noise that fades with it.

use std::f64::consts::TAU;

use super::fading::{Window, window};
use super::skirts::skirts;

/// Least number of samples of a record that is looked at.
const LEAST: usize = 256;

/// What was done to a record before.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Treatment {
    /// A filter whose edges (Hz) lie beside the mode; none: no edge on that side.
    Filtered {
        /// Lower edge, Hz.
        low: Option<f64>,
        /// Upper edge, Hz.
        high: Option<f64>,
    },
    /// The window exp(-t/τ).
    Exponential {
        /// τ, s.
        time_constant: f64,
    },
    /// The Hann window, from zero at the begin to zero at the end.
    Hann,
    /// The Hamming window, from 8 % at the begin to 8 % at the end.
    Hamming,
    /// A window that nothing in the samples shows, but that is known to lie over the record ([`Options::windowed`](crate::signal::Options)).
    Declared,
}

/// A filter whose edges lie farther than this factor from the mode's frequency leaves the decay as it is. Of 22 fits behind band-passes of third to sixth order with edges a
/// factor of 1.6 to 2.5 from a mode of 124 Hz, in one pass and in both, two had an interval that excluded the truth, by less than its width; of 6 with a factor of 1.22 three had.
const NEAR: f64 = 1.5;

impl Treatment {
    /// Whether it changes the decay of a mode of `frequency` Hz so much that the record tells none of its parameters: any window does, and a filter with an edge next to the mode.
    ///
    /// ```
    /// use iwan_ident::signal::Treatment;
    /// let filter = Treatment::Filtered { low: Some(50.0), high: Some(350.0) };
    /// assert!(!filter.spoils(124.0) && filter.spoils(243.0));
    /// ```
    #[must_use]
    pub fn spoils(&self, frequency: f64) -> bool {
        match *self {
            Self::Filtered { low, high } => {
                low.is_some_and(|low| frequency < NEAR * low)
                    || high.is_some_and(|high| high < NEAR * frequency)
            }
            _ => true,
        }
    }

    /// What was seen, what it does to a mode of `frequency` Hz, and what helps, in words.
    #[must_use]
    pub fn in_words(&self, frequency: f64) -> String {
        let filtered = |what: &str, where_: String| {
            let so = if self.spoils(frequency) {
                "and the decay is the structure's and the filter's together; give the record as it was measured"
            } else {
                "but too far from the mode to change its decay by much"
            };
            format!(
                "the record was {what} before: {where_} its spectrum falls by decades within an octave, as no measured noise does, {so}"
            )
        };
        let windowed = |name: &str| {
            format!(
                "a {name} window lies over the record: its noise rises and falls with the window, where measured noise goes on as it is, and the decay is the structure's and the window's \
                 together; give the record as it was measured"
            )
        };
        match *self {
            Self::Filtered { low: Some(low), high: Some(high) } => {
                filtered("band-passed", format!("below about {low:.4} and above {high:.4} Hz"))
            }
            Self::Filtered { low: Some(low), .. } => {
                filtered("high-passed", format!("below about {low:.4} Hz"))
            }
            Self::Filtered { high, .. } => {
                filtered("low-passed", format!("above about {:.4} Hz", high.unwrap_or_default()))
            }
            Self::Exponential { time_constant } => {
                let damping = 100.0 / (TAU * frequency * time_constant);
                format!(
                    "an exponential window lies over the record: its noise falls as exp(-t/τ) with τ = {time_constant:.4} s, where measured noise goes on as it is, and the window adds \
                     {damping:.4} % to the damping ratio at {frequency:.2} Hz; give the record as it was measured, for the window can be taken off only where it is known exactly"
                )
            }
            Self::Hann => windowed("Hann"),
            Self::Hamming => windowed("Hamming"),
            Self::Declared => "a window lies over the record, as its file says: the decay is the structure's and the window's together; export the record without it".into(),
        }
    }
}

/// What was done before to a record (any unit, every `dt` seconds) in which a mode has its spectral peak at `peak` Hz; none where nothing is seen of it.
///
/// A filter is seen by the spectrum of noise and other modes beside the mode: it falls by three decades within half an octave and stays down, within a factor of three of the mode's
/// frequency. A window is seen by noise off the mode that follows it in eight parts of the record. Records without noise show neither, and filters of first order, which fall slowly,
/// are not seen.
///
/// ```
/// use iwan_ident::signal::{Butterworth, Passband, Treatment, treatment};
/// let mut noise = iwan_core::SplitMix64::new(1);
/// let dt = 2e-4;
/// let x: Vec<f64> = (0..8192).map(|n| n as f64 * dt)
///     .map(|t| (-t).exp() * (std::f64::consts::TAU * 124.0 * t).cos() + 1e-2 * noise.next_symmetric()).collect();
/// assert_eq!(treatment(&x, dt, 124.0), None);
/// let passed = Butterworth::new(3, Passband::Band { low: 100.0, high: 150.0 }, dt)?.forward_backward(&x)?;
/// let Some(Treatment::Filtered { low: Some(low), high: Some(high) }) = treatment(&passed, dt, 124.0) else { panic!() };
/// assert!((80.0..120.0).contains(&low) && (135.0..165.0).contains(&high), "{low} {high}");
/// # Ok::<(), iwan_ident::Error>(())
/// ```
#[must_use]
pub fn treatment(x: &[f64], dt: f64, peak: f64) -> Option<Treatment> {
    if x.len() < LEAST || !(dt > 0.0 && peak > 0.0) || x.iter().any(|x| !x.is_finite()) {
        return None;
    }
    match skirts(x, dt, peak) {
        [None, None] => window(x, dt, peak).map(|window| match window {
            Window::Exponential(time_constant) => Treatment::Exponential { time_constant },
            Window::Hann => Treatment::Hann,
            Window::Hamming => Treatment::Hamming,
        }),
        [low, high] => Some(Treatment::Filtered { low, high }),
    }
}
