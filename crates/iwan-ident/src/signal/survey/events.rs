//! Defects of a record with their times: clipping, jumps of the zero line, wild and lost samples.

use super::breaks::{Breaks, Place, breaks};
use super::peak_list::spectral_peaks;
use crate::error::Error;
use crate::signal::defects::clipped_runs;

/// Only peaks of at least this fraction of the height of the highest move averages; the slowest of them sets the time over which averages are taken.
const SEEN: f64 = 0.02;
/// Cycles of that slowest peak over which the zero line is averaged on either side of a jump.
const CYCLES: f64 = 10.0;
/// A jump is at least this many times the median difference of neighbouring averages.
const MEDIANS: f64 = 12.0;
/// A jump is also at least this fraction of the largest sample: a smaller one is lost in what else the averages leave.
const PART: f64 = 5e-3;
/// The same fraction for the first average, before which nothing was seen: a vibration that begins with the record leaves a sixtieth of itself in that one, and nothing in the
/// next.
const AT_BEGIN: f64 = 0.05;
/// The fraction of a jump that is still there ten cycles away: with less it is a pulse, with more a drift.
const LASTS: (f64, f64) = (0.7, 1.3);

/// A disturbance of a record, with its time.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Event {
    /// Samples stand at the end of the measuring range from one time to another (s from the first sample).
    Clipped {
        /// First clipped sample, s.
        from: f64,
        /// Last clipped sample, s.
        to: f64,
        /// The range, in the unit of the record.
        level: f64,
    },
    /// The zero line jumps at a time (s from the first sample) and stays there.
    Jump {
        /// s.
        time: f64,
        /// In the unit of the record.
        size: f64,
    },
    /// Single samples stand alone, as a disturbed transmission makes them.
    Wild {
        /// The first of them, s from the first sample.
        time: f64,
        /// How far it lies off its neighbours, in the unit of the record.
        size: f64,
        /// How many there are.
        count: usize,
    },
    /// The vibration breaks off between two samples and goes on elsewhere: some samples in between are missing.
    Lost {
        /// First sample behind the first such place, s from the first sample.
        time: f64,
        /// How many places there are.
        count: usize,
    },
    /// The decay is driven again, too early or too weakly to begin a stretch of its own: a double hit, or another disturbance.
    Driven {
        /// s from the first sample.
        time: f64,
    },
}

impl Event {
    /// When it happens, s from the first sample: the first time where it happens more than once.
    #[must_use]
    pub fn time(&self) -> f64 {
        match *self {
            Self::Clipped { from: time, .. }
            | Self::Jump { time, .. }
            | Self::Wild { time, .. }
            | Self::Lost { time, .. }
            | Self::Driven { time } => time,
        }
    }

    /// What kind it is, in a word: `clipped`, `jump`, `wild`, `lost` or `driven`.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Clipped { .. } => "clipped",
            Self::Jump { .. } => "jump",
            Self::Wild { .. } => "wild",
            Self::Lost { .. } => "lost",
            Self::Driven { .. } => "driven",
        }
    }

    /// The same event in a record that begins `by` seconds earlier.
    pub(super) fn later(mut self, by: f64) -> Self {
        match &mut self {
            Self::Clipped { from, to, .. } => {
                *from += by;
                *to += by;
            }
            Self::Jump { time, .. }
            | Self::Wild { time, .. }
            | Self::Lost { time, .. }
            | Self::Driven { time } => *time += by,
        }
        self
    }
}

/// What happens, in words without the time.
impl std::fmt::Display for Event {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let others = |f: &mut std::fmt::Formatter<'_>, count: usize, what: &str| {
            if count > 1 { write!(f, " ({count} such {what})") } else { Ok(()) }
        };
        match *self {
            Self::Clipped { level, .. } => {
                write!(f, "the samples stand at the end of their range, {level:.4}")
            }
            Self::Jump { size, .. } => write!(f, "the zero line jumps by {size:.4}"),
            Self::Wild { size, count, .. } => {
                write!(f, "one sample stands {size:.4} off its neighbours")?;
                others(f, count, "samples")
            }
            Self::Lost { count, .. } => {
                write!(f, "the vibration breaks off, as where samples are lost")?;
                others(f, count, "places")
            }
            Self::Driven { .. } => write!(f, "the decay is driven again, as by a double hit"),
        }
    }
}

/// Clipping, the largest jump of the zero line, wild and lost samples in a record of any unit, sampled every `dt` seconds.
///
/// Clipped: the largest or the smallest value stands three times in a row, in two places or more. A jump: averages over ten cycles of the slowest peak before and behind it
/// differ twelve times as much as such averages do elsewhere. Wild and lost samples: the deviation of a sample from the cubic through its four neighbours is ten times as
/// large as around it and has the form that a single wrong sample or a step leaves; only records of eight samples a cycle and more show that.
///
/// # Errors
/// [`Error::OutOfRange`] for `dt`, [`Error::NotFinite`], [`Error::TooShort`] below 64 samples.
///
/// ```
/// use iwan_ident::signal::{Event, events};
/// let x: Vec<f64> = (0..3000).map(|n| (-1e-3 * n as f64).exp() * (0.3 * n as f64).sin()).collect();
/// assert!(events(&x, 1e-3)?.is_empty());
/// let stepped: Vec<f64> = x.iter().enumerate().map(|(n, x)| x + if n < 2000 { 0.0 } else { 0.05 }).collect();
/// assert!(matches!(events(&stepped, 1e-3)?[..], [Event::Jump { time, .. }] if (time - 2.0).abs() < 0.02));
/// # Ok::<(), iwan_ident::Error>(())
/// ```
pub fn events(x: &[f64], dt: f64) -> Result<Vec<Event>, Error> {
    let peaks = spectral_peaks(&[x], dt)?;
    let cycle = peaks.iter().find(|p| p.height > SEEN).map(|p| 1.0 / (p.frequency * dt));
    let jump = cycle.and_then(|cycle| jump(x, dt, cycle));
    let Breaks { wild, lost } = cycle.map_or_else(Breaks::default, |cycle| breaks(x, cycle));
    let first = |places: &[Place]| places.first().map(|p| (p.at as f64 * dt, p.size, places.len()));
    let wild = first(&wild).map(|(time, size, count)| Event::Wild { time, size, count });
    // A jump of the zero line looks like lost samples as well, and is reported once.
    let lost = first(&lost).filter(|_| jump.is_none()).map(|(time, _, count)| Event::Lost { time, count });
    Ok(clipped(x, dt).into_iter().chain(jump).chain(wild).chain(lost).collect())
}

fn clipped(x: &[f64], dt: f64) -> Option<Event> {
    let runs = clipped_runs(x);
    let (first, last) = (runs.first()?, runs.last()?);
    let level = x[first.start].abs();
    Some(Event::Clipped { from: first.start as f64 * dt, to: (last.end - 1) as f64 * dt, level })
}

/// The largest jump of the zero line, if it stands out; `cycle` in samples.
fn jump(x: &[f64], dt: f64, cycle: f64) -> Option<Event> {
    // The record is averaged over a third of CYCLES, three times in succession: that makes an oscillation smaller by a thousand, and a hit with it.
    let length = (CYCLES / 3.0 * cycle).round().max(4.0) as usize;
    let zero = averaged(&averaged(&averaged(x, length)?, length)?, length)?;
    let reach = 3 * length;
    let count = zero.len().checked_sub(reach).filter(|n| *n > 2 * reach)?;
    let differences: Vec<f64> = (0..count).map(|i| zero[i + reach] - zero[i]).collect();
    let mut sorted: Vec<f64> = differences.iter().map(|d| d.abs()).collect();
    let middle = sorted.len() / 2;
    let median = *sorted.select_nth_unstable_by(middle, f64::total_cmp).1;
    let loudest = x.iter().map(|x| x.abs()).fold(0.0, f64::max);
    // A jump lasts; a pulse leaves nothing in averages that keep away from it.
    let kept = |i: usize| zero[(i + 2 * reach).min(zero.len() - 1)] - zero[i.saturating_sub(reach)];
    let stands = |i: &usize| {
        let size = differences[*i];
        let part = if *i < reach { AT_BEGIN } else { PART };
        let all = size.abs() > MEDIANS * median && size.abs() > part * loudest;
        all && (LASTS.0..=LASTS.1).contains(&(kept(*i) / size))
    };
    let at =
        (0..count).filter(stands).max_by(|&i, &j| differences[i].abs().total_cmp(&differences[j].abs()))?;
    // Each average reaches ahead of its index by that much, and the jump is in the middle between the two averages.
    let i = at + reach / 2 + 3 * (length - 1) / 2;
    Some(Event::Jump { time: i as f64 * dt, size: differences[at] })
}

/// Running mean of `length` samples.
fn averaged(x: &[f64], length: usize) -> Option<Vec<f64>> {
    let count = (x.len() + 1).checked_sub(length).filter(|n| *n > 0)?;
    let mut sum: f64 = x[..length].iter().sum();
    let mut means = Vec::with_capacity(count);
    for i in 0..count {
        means.push(sum / length as f64);
        if i + length < x.len() {
            sum += x[i + length] - x[i];
        }
    }
    Some(means)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decay(n: usize) -> f64 {
        (-1e-3 * n as f64).exp() * (0.2 * n as f64).sin()
    }

    #[test]
    fn clipping_is_told_with_its_times() {
        let clipped: Vec<f64> = (0..3000).map(|n| decay(n).clamp(-0.6, 0.7)).collect();
        let found = events(&clipped, 1e-3).unwrap();
        let Some(&Event::Clipped { from, to, level }) = found.first() else { panic!("{found:?}") };
        assert!(from < 0.02 && to > 0.3 && to < 0.6 && (level - 0.7).abs() < 0.11, "{found:?}");
    }

    #[test]
    fn a_hit_and_a_drift_are_no_jumps() {
        let struck: Vec<f64> =
            (0..4000).map(|n| if n < 800 { 0.0 } else { decay(n - 800) } + 1e-6 * n as f64).collect();
        assert_eq!(events(&struck, 1e-3).unwrap(), []);
        let jumped: Vec<f64> =
            struck.iter().enumerate().map(|(n, x)| if n < 2500 { *x } else { x - 0.03 }).collect();
        // A decay of three per cent that begins with the record has a mean of its own while it lasts.
        let fast: Vec<f64> =
            (0..8000).map(|n| (-6e-3 * f64::from(n)).exp() * (0.2 * f64::from(n)).sin()).collect();
        assert_eq!(events(&fast, 1e-3).unwrap(), []);
        let found = events(&jumped, 1e-3).unwrap();
        let [Event::Jump { time, size }] = found[..] else { panic!("{found:?}") };
        assert!((time - 2.5).abs() < 0.02 && (size + 0.03).abs() < 5e-3, "{found:?}");
    }
}
