//! A first look over a record before anything is taken out of it: its hits, and what disturbs it.

use std::ops::Range;

use super::events::{Event, events};
use super::hits::{Hit, hits};

/// The hits of a record and what disturbs it, seen in its loudest channel.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Overview {
    /// The hits, as [`hits`] finds them.
    pub hits: Vec<Hit>,
    /// Disturbances of the record from its release on, with times in s from the first sample: defects as [`events`] finds them, then the times at which it is driven again
    /// within a stretch.
    pub events: Vec<Event>,
    length: usize,
}

impl Overview {
    /// Index of the first sample behind the lead-in, in which the structure is pulled, held, handled or driven before the first hit; 0 without a lead-in.
    #[must_use]
    pub fn release(&self) -> usize {
        self.hits.first().filter(|hit| hit.lead_in).map_or(0, |hit| hit.samples.start)
    }

    /// Ranges of samples, one for each record that a fit makes of this one: every stretch where there are several hits, else all samples from the release on.
    #[must_use]
    pub fn stretches(&self) -> Vec<Range<usize>> {
        let alone = self.release()..self.length;
        if self.hits.len() > 1 {
            self.hits.iter().map(|hit| hit.samples.clone()).collect()
        } else {
            Vec::from([alone])
        }
    }
}

/// Looks over a record of any number of channels, sampled every `dt` seconds.
///
/// A record without channels, or one too short or not finite, gives neither hits nor events: it is refused where it is used.
///
/// ```
/// let decay = |n: usize| (-4e-3 * n as f64).exp() * (0.6 * n as f64).sin();
/// let struck: Vec<f64> = (0..4000).map(|n| if n < 300 { 0.0 } else { decay(n - 300) }).collect();
/// let seen = iwan_ident::signal::overview(&[vec![0.0; 4000], struck], 1e-3);
/// assert_eq!((seen.hits.len(), seen.events.len(), seen.stretches()), (1, 0, vec![0..4000]));
/// ```
#[must_use]
pub fn overview(channels: &[Vec<f64>], dt: f64) -> Overview {
    let peak = |x: &[f64]| x.iter().map(|x| x.abs()).fold(0.0, f64::max);
    let Some(x) = channels.iter().max_by(|a, b| peak(a).total_cmp(&peak(b))) else {
        return Overview::default();
    };
    let hits = hits(x, dt).unwrap_or_default();
    let mut seen = Overview { hits, events: Vec::new(), length: x.len() };
    let release = seen.release();
    let disturbed = events(&x[release..], dt).unwrap_or_default();
    let again = seen.hits.iter().flat_map(|hit| &hit.again).map(|time| Event::Driven { time: *time });
    seen.events = disturbed.into_iter().map(|event| event.later(release as f64 * dt)).chain(again).collect();
    seen
}
