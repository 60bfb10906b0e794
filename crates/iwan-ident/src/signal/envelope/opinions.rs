//! How far the methods disagree on one record.

use super::super::in_band::Options;
use super::super::isolate::isolate;
use super::super::isolated::Isolated;
use super::instantaneous::{Envelope, Method};
use crate::error::Error;

/// Number of times at which methods are compared: their disagreement is given as a median and a largest value, which more times do not change.
const POINTS: usize = 200;

/// Largest differences between methods over the window that all of them trust.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// Start and end of that window, s.
    pub window: (f64, f64),
    /// Largest difference in amplitude over the mean of the methods.
    pub amplitude: f64,
    /// Largest difference in frequency, Hz.
    pub frequency: f64,
    /// Largest difference in damping ratio over the mean of the methods.
    pub damping_ratio: f64,
    /// Median over time of the difference in damping ratio over the mean of the methods.
    pub median_damping_ratio: f64,
}

impl Spread {
    /// Compares envelopes of one record; none when they have no window in common or there are fewer than two.
    #[must_use]
    pub fn of(envelopes: &[Envelope]) -> Option<Self> {
        let start = envelopes.iter().map(|e| e.trusted.0).fold(f64::NEG_INFINITY, f64::max);
        let end = envelopes.iter().map(|e| e.trusted.1).fold(f64::INFINITY, f64::min);
        if envelopes.len() < 2 || start >= end {
            return None;
        }
        let mut spread = Self {
            window: (start, end),
            amplitude: 0.0,
            frequency: 0.0,
            damping_ratio: 0.0,
            median_damping_ratio: 0.0,
        };
        let mut damping = Vec::with_capacity(POINTS + 1);
        for i in 0..=POINTS {
            let t = (start + (end - start) * i as f64 / POINTS as f64).min(end);
            let all: Vec<_> = envelopes.iter().filter_map(|e| e.at(t)).collect();
            let amplitude = Scatter::of(all.iter().map(|e| e.amplitude));
            let ratio = Scatter::of(all.iter().map(|e| e.damping_ratio));
            spread.amplitude = spread.amplitude.max(amplitude.difference / amplitude.mean);
            spread.frequency = spread.frequency.max(Scatter::of(all.iter().map(|e| e.frequency)).difference);
            damping.push(ratio.difference / ratio.mean.abs());
        }
        damping.sort_by(f64::total_cmp);
        (spread.damping_ratio, spread.median_damping_ratio) = (damping[POINTS], damping[POINTS / 2]);
        Some(spread)
    }
}

/// Spread of one quantity over several methods.
struct Scatter {
    /// Largest difference.
    difference: f64,
    mean: f64,
}

impl Scatter {
    fn of(values: impl Iterator<Item = f64>) -> Self {
        let start = (f64::INFINITY, f64::NEG_INFINITY, 0.0, 0.0);
        let (low, high, sum, count) = values.fold(start, |s, v| (s.0.min(v), s.1.max(v), s.2 + v, s.3 + 1.0));
        Self { difference: high - low, mean: sum / count }
    }
}

/// A method that could not be used.
#[derive(Debug, Clone, PartialEq)]
pub struct Refusal {
    /// The method.
    pub method: Method,
    /// Why it could not be used.
    pub error: Error,
}

/// What the methods say on one mode of a record.
#[derive(Debug, Clone, PartialEq)]
pub struct Opinions {
    /// One envelope per method that could be used, in the order of [`Method::INDEPENDENT`].
    pub envelopes: Vec<Envelope>,
    /// The methods that could not be used.
    pub refused: Vec<Refusal>,
    /// How far the envelopes disagree.
    pub spread: Option<Spread>,
}

/// Envelope and frequency by all methods.
///
/// # Errors
/// As [`isolate`]; the refusal of a single method stands in the result.
///
/// ```
/// use iwan_ident::signal::{Options, opinions};
/// let decay = |n: usize| (-1.0 * n as f64 / 4096.0).exp() * (500.0 * n as f64 / 4096.0).cos();
/// let x: Vec<f64> = (0..8192).map(decay).collect();
/// let opinions = opinions(&x, 1.0 / 4096.0, &Options::default())?;
/// assert!(opinions.spread.is_some_and(|s| s.median_damping_ratio < 0.01));
/// # Ok::<(), iwan_ident::Error>(())
/// ```
pub fn opinions(x: &[f64], dt: f64, options: &Options) -> Result<Opinions, Error> {
    Ok(isolate(x, dt, options)?.opinions(options.order))
}

impl Isolated {
    /// What all methods say on this mode; `order` as in [`Options::order`], for the Hilbert method alone.
    #[must_use]
    pub fn opinions(&self, order: Option<usize>) -> Opinions {
        let (mut envelopes, mut refused) = (Vec::new(), Vec::new());
        for method in Method::INDEPENDENT {
            match self.envelope(method, order.filter(|_| method == Method::Hilbert)) {
                Ok(envelope) => envelopes.push(envelope),
                Err(error) => refused.push(Refusal { method, error }),
            }
        }
        let spread = Spread::of(&envelopes);
        Opinions { envelopes, refused, spread }
    }
}
