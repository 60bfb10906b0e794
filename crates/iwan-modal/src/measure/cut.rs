//! Several hits in one record, cut apart.

use super::hit::{Channel, Hit};
use super::pulse::Pulse;
use crate::number::median;

/// A pulse of at least this fraction of the highest is a hit of its own; lower ones are reported as faults of the hit before.
const HIT: f64 = 0.1;
/// A pulse this close behind the one before (s) is a double hit: a hammer that bounces comes back after 5 to 50 ms, a hand strikes anew after more
/// than 0.2 s.
pub(super) const BOUNCE: f64 = 0.1;
/// Number of samples that are kept before a pulse when a record is cut: its foot, and enough to see whether something moved before.
const BEFORE: usize = 16;

/// Cuts a record at its hits: each hit gets a name with its number, and ends where the next one begins. A record of one hit stays whole.
///
/// ```
/// use iwan_modal::measure::{Channel, Freedom, Hit, cut};
/// let channel = |name: &str, samples| Channel { name: name.into(), freedom: Freedom::point(name), samples };
/// let force = (0..4000).map(|n| if n == 100 || n == 2100 { 1.0 } else { 0.0 }).collect();
/// let tip = (0..4000).map(|n| (0.1 * n as f64).sin()).collect();
/// let record = Hit { name: "taps.csv".into(), dt: 1e-3, force: channel("hammer", force), responses: vec![channel("tip", tip)] };
/// let hits = cut(record);
/// assert_eq!((hits.len(), hits[1].name.as_str(), hits[0].samples()), (2, "taps.csv, hit 2", 2084));
/// ```
#[must_use]
pub fn cut(record: Hit) -> Vec<Hit> {
    let starts = starts(&record.force.samples, record.dt);
    if starts.len() < 2 {
        return vec![record];
    }
    let n = record.samples();
    let first = |i: usize| if i == 0 { 0 } else { starts[i] - BEFORE.min(starts[i] - starts[i - 1]) };
    let stretch = |i: usize| {
        let range = first(i)..if i + 1 < starts.len() { first(i + 1) } else { n };
        let part = |c: &Channel| Channel { samples: c.samples[range.clone()].to_vec(), ..c.clone() };
        Hit {
            name: format!("{}, hit {}", record.name, i + 1),
            dt: record.dt,
            force: part(&record.force),
            responses: record.responses.iter().map(part).collect(),
        }
    };
    (0..starts.len()).map(stretch).collect()
}

/// First samples of the pulses that are hits of their own.
fn starts(force: &[f64], dt: f64) -> Vec<usize> {
    let (pulses, highest) = pulses(force);
    let mut starts: Vec<usize> = Vec::new();
    for pulse in pulses.iter().filter(|p| p.peak >= HIT * highest) {
        let last = starts.last().copied();
        if last.is_none_or(|last| (pulse.start - last) as f64 * dt > BOUNCE) {
            starts.push(pulse.start);
        }
    }
    starts
}

/// A stretch in which the force is above its noise.
#[derive(Debug, Clone, Copy)]
pub(super) struct Touch {
    pub(super) start: usize,
    pub(super) peak: f64,
}

/// Largest number of successive samples below the noise's limit within one pulse: a pulse has one crest, noise on it makes more.
const GAP: usize = 4;

/// The pulses in a record of force, and the height of the highest.
pub(super) fn pulses(force: &[f64]) -> (Vec<Touch>, f64) {
    let zero = median(force);
    let centred: Vec<f64> = force.iter().map(|f| f - zero).collect();
    let level = Pulse::threshold(&centred);
    let mut pulses: Vec<Touch> = Vec::new();
    let mut last = None;
    for (n, f) in centred.iter().enumerate().filter(|(_, f)| f.abs() > level) {
        match (pulses.last_mut(), last) {
            (Some(pulse), Some(before)) if n - before <= GAP => pulse.peak = pulse.peak.max(f.abs()),
            _ => pulses.push(Touch { start: n, peak: f.abs() }),
        }
        last = Some(n);
    }
    let highest = pulses.iter().map(|p| p.peak).fold(0.0, f64::max);
    (pulses, highest)
}
