//! The quality of hits: what is wrong with each is reported, and what follows from it is left to the user.

use std::fmt;

use super::cut::pulses;
use super::hit::{Channel, Hit};
use crate::number::{extent, median};

/// A second pulse of more than this fraction of the first makes a double hit: a smaller one changes responses by less than the spread of sensors.
const DOUBLE: f64 = 0.02;
/// Equal samples in a row at the largest or smallest value that count as overload.
const RUN: usize = 3;
/// Least number of places with such samples in an overloaded channel: a digitised crest can be flat once.
const PLACES: usize = 2;
/// A hammer's force has one crest, so that one run of equal samples is enough, if it is longer than this fraction of the samples above half the peak: of a half sine digitised
/// in 8 bits the crest is flat over a twelfth of them.
const CREST: f64 = 0.3;
/// A response before the hit of more than this fraction of its peak is the decay of an earlier motion. Noise of 40 dB is below.
const MOVING: f64 = 0.05;
/// Least number of samples before the pulse: with fewer nothing can be said of what was there before, and the pulse's foot may be missing.
const BEFORE: usize = 8;
/// Successive hits of one level, in the order of force, differ by less than this factor; a larger gap begins the next level.
const LEVEL: f64 = 1.5;

/// What is wrong with a hit.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Fault {
    /// The hammer bounced and hit a second time.
    DoubleHit {
        /// Time of the second pulse, s from the first sample.
        time: f64,
        /// Its height over that of the first pulse.
        part: f64,
    },
    /// Samples of a channel stand at the end of its measuring range.
    Overload {
        /// Name of the channel.
        channel: String,
        /// The range, in the unit of the channel.
        level: f64,
        /// Number of such samples.
        samples: usize,
    },
    /// The force has no pulse above its noise.
    NoPulse {
        /// Channel of the hammer.
        channel: String,
    },
    /// The record begins with the hit, without samples before it.
    NoPretrigger {
        /// Samples before the pulse.
        samples: usize,
    },
    /// A channel still moves when the hit comes, because it came during the decay of the last one.
    StillMoving {
        /// Name of the channel that moves most relative to its peak.
        channel: String,
        /// Largest value before the hit over the largest after it.
        part: f64,
    },
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::DoubleHit { time, part } => {
                write!(f, "double hit: a second pulse of {:.0} % of the first at {time:.4} s", 100.0 * part)
            }
            Self::Overload { channel, level, samples } => {
                write!(f, "channel {channel} is overloaded: {samples} samples stand at {level:.6}")
            }
            Self::NoPulse { channel } => {
                write!(
                    f,
                    "no pulse stands out of the noise of channel {channel}: there is no hit, or it is not the hammer"
                )
            }
            Self::NoPretrigger { samples } => {
                write!(f, "{samples} samples before the pulse: the begin of the hit may be missing")
            }
            Self::StillMoving { channel, part } => write!(
                f,
                "channel {channel} still moves when the hit comes, at {:.0} % of its peak: it came during the decay of the last",
                100.0 * part
            ),
        }
    }
}

/// What is wrong with a hit; empty where nothing is.
///
/// ```
/// use iwan_modal::measure::{Channel, Fault, Freedom, Hit, faults};
/// let channel = |name: &str, samples| Channel { name: name.into(), freedom: Freedom::point(name), samples };
/// let force = (0..500).map(|n| if n == 100 { 8.0 } else if n == 130 { 2.0 } else { 0.0 }).collect();
/// let tip = (0..500).map(|n| if n < 100 { 0.0 } else { (0.3 * n as f64).sin() }).collect();
/// let hit = Hit { name: "tap".into(), dt: 1e-3, force: channel("hammer", force), responses: vec![channel("tip", tip)] };
/// assert_eq!(faults(&hit), [Fault::DoubleHit { time: 0.13, part: 0.25 }]);
/// ```
#[must_use]
pub fn faults(hit: &Hit) -> Vec<Fault> {
    let mut found = Vec::new();
    let (pulses, _) = pulses(&hit.force.samples);
    let Some(first) = pulses.iter().max_by(|a, b| a.peak.total_cmp(&b.peak)) else {
        found.push(Fault::NoPulse { channel: hit.force.name.clone() });
        return found;
    };
    let others = pulses.iter().filter(|p| p.start != first.start && p.peak > DOUBLE * first.peak);
    found.extend(
        others.map(|p| Fault::DoubleHit { time: p.start as f64 * hit.dt, part: p.peak / first.peak }),
    );
    let onset = pulses.first().map_or(0, |p| p.start);
    let end = if onset < BEFORE { 0 } else { onset - BEFORE / 2 };
    found.extend(flat_crest(&hit.force).or_else(|| overload(&hit.force, &Ranges::new(&hit.force, end))));
    // One channel after another, because the samples of one stay in the processor's cache.
    let of_channel = |channel: &Channel| {
        let ranges = Ranges::new(channel, end);
        (overload(channel, &ranges), moving(channel, &ranges))
    };
    let (overloads, parts): (Vec<_>, Vec<_>) = hit.responses.iter().map(of_channel).unzip();
    found.extend(overloads.into_iter().flatten());
    if onset < BEFORE {
        found.push(Fault::NoPretrigger { samples: onset });
    } else {
        found.extend(still_moving(hit, &parts));
    }
    found
}

/// Smallest and largest samples of a channel before a sample and from there on.
struct Ranges {
    end: usize,
    before: (f64, f64),
    after: (f64, f64),
}

impl Ranges {
    fn new(channel: &Channel, end: usize) -> Self {
        let (before, after) = channel.samples.split_at(end.min(channel.samples.len()));
        Self { end, before: extent(before), after: extent(after) }
    }

    /// Smallest and largest of all samples.
    fn whole(&self) -> (f64, f64) {
        (self.before.0.min(self.after.0), self.before.1.max(self.after.1))
    }
}

fn overload(channel: &Channel, ranges: &Ranges) -> Option<Fault> {
    let x = &channel.samples;
    let (low, high) = ranges.whole();
    // Most channels have too few samples at the ends of their range, which one fast pass tells.
    let at_ends = x.iter().map(|v| usize::from(*v == low) + usize::from(*v == high)).sum::<usize>();
    if at_ends < RUN * PLACES {
        return None;
    }
    let mut zero = None;
    let (mut from, mut runs, mut samples) = (0, 0, 0);
    while from < x.len() {
        if x[from] != low && x[from] != high {
            from += 1;
            continue;
        }
        let run = x[from..].iter().take_while(|v| **v == x[from]).count();
        // A zero line below which a channel never falls is not the end of its range. Few channels have such a run, so the median is computed only when one does.
        if run >= RUN && x[from] != *zero.get_or_insert_with(|| median(x)) {
            (runs, samples) = (runs + 1, samples + run);
        }
        from += run;
    }
    let level = high.abs().max(low.abs());
    (runs >= PLACES).then(|| Fault::Overload { channel: channel.name.clone(), level, samples })
}

/// An overload of the hammer's channel where its highest pulse is cut off.
fn flat_crest(force: &Channel) -> Option<Fault> {
    let x = &force.samples;
    let zero = median(x);
    let height = |v: &f64| (v - zero).abs();
    let peak = x.iter().map(height).fold(0.0, f64::max);
    let at = x.iter().position(|v| height(v) == peak)?;
    let run = x[at..].iter().take_while(|v| **v == x[at]).count();
    let above = |v: &&f64| height(v) > 0.5 * peak;
    let wide = x[at..].iter().take_while(above).count() + x[..at].iter().rev().take_while(above).count();
    let flat = run >= RUN && run as f64 > CREST * wide as f64;
    flat.then(|| Fault::Overload { channel: force.name.clone(), level: x[at].abs(), samples: run })
}

/// Whether a channel is still before the pulse without a doubt; then its median, which costs more than all else, is not needed. The median lies within a stretch of
/// values where fewer than half of the samples lie below the stretch and fewer than half above; within the stretch tested here no zero line makes the start larger than MOVING
/// of the rest.
fn surely_still(x: &[f64], ranges: &Ranges) -> bool {
    let ((low, high), (least, most)) = (ranges.before, ranges.after);
    let within = 0.5 * MOVING * (most - least);
    let (under, over) = (high - within, low + within);
    let counted = |(below, above): (usize, usize), v: &f64| {
        (below + usize::from(*v < under), above + usize::from(*v > over))
    };
    let (below, above) = x.iter().fold((0, 0), counted);
    high - low < within && 2 * below < x.len() - 1 && 2 * above < x.len() - 1
}

/// The largest sample of a channel before the pulse over the largest after it, both from its median; none where it is still without a doubt.
fn moving(channel: &Channel, ranges: &Ranges) -> Option<f64> {
    let x = &channel.samples;
    if ranges.end == 0 || surely_still(x, ranges) {
        return None;
    }
    let zero = median(x);
    let largest = |(low, high): (f64, f64)| (high - zero).max(zero - low);
    Some(largest(ranges.before) / largest(ranges.after).max(f64::MIN_POSITIVE))
}

/// The channel that moves most before the pulse; `parts` are those of [`moving`].
fn still_moving(hit: &Hit, parts: &[Option<f64>]) -> Option<Fault> {
    let known = hit.responses.iter().zip(parts).filter_map(|(channel, part)| Some((channel, (*part)?)));
    let (channel, part) = known.max_by(|a, b| a.1.total_cmp(&b.1))?;
    (part > MOVING).then(|| Fault::StillMoving { channel: channel.name.clone(), part })
}

/// Indices of hits by level of force, the softest level first. A level ends where the next harder hit is at least 1.5 times as hard.
///
/// ```
/// let peaks = [50.0, 10.0, 55.0, 12.0, 200.0];
/// assert_eq!(iwan_modal::measure::levels(&peaks), [vec![1, 3], vec![0, 2], vec![4]]);
/// ```
#[must_use]
pub fn levels(peaks: &[f64]) -> Vec<Vec<usize>> {
    let mut order: Vec<usize> = (0..peaks.len()).collect();
    order.sort_by(|a, b| peaks[*a].total_cmp(&peaks[*b]));
    let mut levels: Vec<Vec<usize>> = Vec::new();
    for i in order {
        match levels.last_mut() {
            Some(level) if level.last().is_some_and(|last| peaks[i] < LEVEL * peaks[*last]) => level.push(i),
            _ => levels.push(vec![i]),
        }
    }
    for level in &mut levels {
        level.sort_unstable();
    }
    levels
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::Freedom;

    fn hit(response: impl Fn(usize) -> f64, onset: usize) -> Hit {
        let channel =
            |name: &str, samples| Channel { name: name.into(), freedom: Freedom::point(name), samples };
        let force = (0..2000).map(|n| if n == onset { 8.0 } else { 0.0 }).collect();
        let tip = (0..2000).map(response).collect();
        Hit {
            name: "tap".into(),
            dt: 1e-3,
            force: channel("hammer", force),
            responses: vec![channel("tip", tip)],
        }
    }

    fn decay(n: usize, onset: usize) -> f64 {
        if n < onset { 0.0 } else { (-2e-3 * (n - onset) as f64).exp() * (0.3 * (n - onset) as f64).sin() }
    }

    /// Noise before the hit, on a zero line with an offset: reported from a twentieth of the peak on, both by the short way without the median and by the median.
    #[test]
    fn what_moves_before_the_hit_is_said_from_a_twentieth_of_the_peak_on() {
        let noise = |n: usize| f64::from(((n * 7919) % 1009) as u32) / 1009.0 - 0.5;
        let mut short_ways = 0;
        for k in 1..40 {
            let size = 0.005 * f64::from(k);
            let hit = hit(|n| 3.0 + if n < 400 { size * noise(n) } else { decay(n, 400) }, 400);
            let x = &hit.responses[0].samples;
            let zero = median(x);
            let largest = |x: &[f64]| x.iter().map(|v| (v - zero).abs()).fold(0.0, f64::max);
            let moves = largest(&x[..396]) > MOVING * largest(&x[396..]);
            let said = faults(&hit).iter().any(|f| matches!(f, Fault::StillMoving { .. }));
            assert_eq!(said, moves, "{size}");
            let still = surely_still(x, &Ranges::new(&hit.responses[0], 396));
            assert!(!(moves && still), "{size}");
            short_ways += usize::from(still);
        }
        assert!((5..35).contains(&short_ways), "{short_ways}");
    }

    #[test]
    fn a_good_hit_has_no_faults_and_a_bad_one_says_which() {
        assert_eq!(faults(&hit(|n| decay(n, 100), 100)), []);
        let clipped = faults(&hit(|n| decay(n, 100).clamp(-0.5, 0.5), 100));
        assert!(
            matches!(&clipped[..], [Fault::Overload { channel, level, .. }] if channel == "tip" && *level == 0.5),
            "{clipped:?}"
        );
        let mut cut_off = hit(|n| decay(n, 100), 100);
        let half_sine = |n: usize| if n < 12 { (std::f64::consts::PI * n as f64 / 12.0).sin() } else { 0.0 };
        let pulse =
            |highest: f64| (0..2000_usize).map(|n| half_sine(n.wrapping_sub(100)).min(highest)).collect();
        cut_off.force.samples = pulse(1.0);
        assert_eq!(faults(&cut_off), []);
        cut_off.force.samples = pulse(0.8);
        assert!(
            matches!(&faults(&cut_off)[..], [Fault::Overload { channel, level, samples: 5 }] if channel == "hammer" && *level == 0.8),
            "{:?}",
            faults(&cut_off)
        );
        // The channel of the hammer holds noise only.
        cut_off.force.samples = (0..2000).map(|n| f64::from((n * 7919) % 101 - 50)).collect();
        assert_eq!(faults(&cut_off), [Fault::NoPulse { channel: "hammer".into() }]);
        let late = faults(&hit(|n| decay(n, 3), 3));
        assert!(matches!(late[..], [Fault::NoPretrigger { samples: 3 }]), "{late:?}");
        let moving = faults(&hit(|n| decay(n, 100) + decay(n, 1000), 1000));
        assert!(
            matches!(&moving[..], [Fault::StillMoving { channel, part }] if channel == "tip" && *part > 0.5),
            "{moving:?}"
        );
    }
}
