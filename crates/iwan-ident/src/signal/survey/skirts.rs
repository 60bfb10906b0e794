//! Skirts that a filter left beside a mode: there the spectrum falls by decades within less than an octave and stays down. Measured noise is level or falls slowly, and a
//! mode's own skirts are steepest next to its peak and level out.

use super::tapered::{LOBE, Tapered};
use crate::signal::spectrum::median;

/// Ratio of the frequencies at the ends of a band in which the median line is taken, and the least number of lines of a band. Medians do not see single lines.
const RATIO: f64 = 1.04;
const LINES: usize = 9;
/// A skirt begins at least this fraction of the mode's frequency, and this many lobes of the window, away from all frequencies of the mode.
const BESIDE: f64 = 0.08;
const LOBES: f64 = 4.0;
/// A skirt begins within this factor of the mode's frequency. A filter farther away hardly changes the mode: anti-aliasing filters and AC coupling are no matter.
const REACH: f64 = 3.0;
/// Up to this fraction of the sampling rate a converter's own filter lets everything through.
const LEVEL: f64 = 0.38;
/// The shelf from which a skirt falls is the lowest band within this factor of frequency, and half of the distance, towards the mode: a line or another mode is no shelf.
const SHELF: f64 = 1.25;
const HALF: f64 = 0.5;
/// The spectrum falls by this many decades within this factor of frequency.
const FALLS: [(f64, f64); 2] = [(1.5, 3.0), (2.0, 4.0)];
/// A shelf of less power than this part of the record's variance may be what changes of a mode's amplitude leave beside its line, and not noise. From there the spectrum falls by so
/// many decades more. In 810 simulations without noise it fell by one decade more than the least at most.
const NOISE: f64 = 3e-8;
const FURTHER: f64 = 1.5;
/// Part of its distance from the mode up to which a shelf is compared with itself: what falls with the distance exponentially or more slowly is the mode's own skirt.
const INSIDE: f64 = 0.7;
/// Largest of these factors.
const WIDEST: f64 = FALLS[1].0;
/// It stays down over this factor of frequency, in this fraction of the bands; with fewer bands nothing is seen.
const STAYS: f64 = 2.0;
const DOWN: f64 = 0.85;
const LEAST_DOWN: usize = 3;
/// The filter's edge stands where the power has fallen to this fraction of the shelf.
const EDGE: f64 = 0.25;
/// Number of parts of the record in which the mode's frequency is followed, and its range there in ratios to that in the whole record.
const PARTS: usize = 8;
const RANGE: (f64, f64) = (0.5, 1.6);
/// A part is looked at where the mode has this fraction of its largest power.
const SEEN: f64 = 1e-6;

/// A band of the spectrum with the median power of its lines.
#[derive(Debug, Clone, Copy)]
struct Step {
    frequency: f64,
    power: f64,
    /// Half the width of the window's lobe over the frequency.
    lobe: f64,
}

/// Frequencies (Hz) at which a filter begins to fall below and above the mode whose spectral peak lies at `peak` Hz, where there is one.
pub(super) fn skirts(x: &[f64], dt: f64, peak: f64) -> [Option<f64>; 2] {
    let whole = Tapered::new(x, dt);
    let [lowest, highest] = swept(x, dt, peak);
    let steps = steps(&whole, peak / (10.0 * REACH), LEVEL / dt - LOBE * whole.step);
    let beside = (BESIDE * peak).max(LOBES * LOBE * whole.step);
    let mean = x.iter().sum::<f64>() / x.len() as f64;
    let least = NOISE * x.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / x.len() as f64;
    // Below the mode everything is mirrored: ratios of frequencies are taken from the inside to the outside.
    let mirror = |frequency: f64| peak * peak / frequency;
    let mirrored: Vec<Step> =
        steps.iter().rev().map(|s| Step { frequency: mirror(s.frequency), ..*s }).collect();
    let below = (lowest > beside).then(|| edge(&mirrored, peak, mirror(lowest - beside), least)).flatten();
    [below.map(mirror), edge(&steps, peak, highest + beside, least)]
}

/// Lowest and highest frequency of the mode, from the peaks of its spectra in parts of the record. In the first part the frequency changes most: the range reaches as far again
/// below it.
fn swept(x: &[f64], dt: f64, peak: f64) -> [f64; 2] {
    let part = |x: &[f64]| -> Option<[f64; 2]> {
        let found = Tapered::new(x, dt);
        let near = |k: &usize| (RANGE.0 * peak..RANGE.1 * peak).contains(&(*k as f64 * found.step));
        let top =
            (0..found.power.len()).filter(near).max_by(|&i, &j| found.power[i].total_cmp(&found.power[j]))?;
        Some([top as f64 * found.step, found.power[top]])
    };
    let parts: Vec<[f64; 2]> = x.chunks_exact((x.len() / PARTS).max(2)).filter_map(part).collect();
    let most = parts.iter().map(|[_, power]| *power).fold(0.0, f64::max);
    let seen = parts.iter().filter(|[_, power]| *power > SEEN * most).map(|[frequency, _]| *frequency);
    let (low, high) = seen.fold((peak, peak), |(low, high), f| (low.min(f), high.max(f)));
    [low - (high - low), high]
}

/// Medians of the lines in bands from `low` to `high` Hz.
fn steps(of: &Tapered, low: f64, high: f64) -> Vec<Step> {
    let mut found = Vec::new();
    let mut from = ((low / of.step).ceil() as usize).max((3.0 * LOBE) as usize);
    let last = ((high / of.step).max(0.0) as usize).min(of.power.len());
    loop {
        let to = ((from as f64 * RATIO).ceil() as usize).max(from + LINES);
        if to > last {
            return found;
        }
        let frequency = 0.5 * (from + to - 1) as f64 * of.step;
        found.push(Step {
            frequency,
            power: median(of.power[from..to].to_vec()),
            lobe: LOBE * of.step / frequency,
        });
        from = to;
    }
}

/// Where the spectrum begins to fall as behind a filter, at `from` or above, looking upwards; `least` is the least power of noise.
fn edge(steps: &[Step], peak: f64, from: f64, least: f64) -> Option<f64> {
    let within = |low: f64, high: f64| steps.iter().filter(move |s| (low..=high).contains(&s.frequency));
    let lowest = |low: f64, high: f64| within(low, high).map(|s| s.power).reduce(f64::min);
    let shelf_that_falls = |at: &Step| -> Option<f64> {
        let distance = at.frequency - peak;
        let half = peak + HALF * distance;
        let shelf = lowest((at.frequency / SHELF).max(half), at.frequency)?;
        let inside = lowest(half - at.lobe * at.frequency, peak + INSIDE * distance)?;
        let sinks = (inside / shelf).log10();
        let further = if shelf < least { FURTHER } else { 0.0 };
        let falls = |(ratio, decades): &(f64, f64)| {
            let end = at.frequency * ratio.max(1.0 + 2.0 * at.lobe);
            let mut beyond: Vec<f64> = within(end, STAYS * end).map(|s| s.power).collect();
            beyond.sort_by(f64::total_cmp);
            let counted = ((DOWN * beyond.len() as f64) as usize).max(1);
            let is_seen = beyond.len() >= LEAST_DOWN;
            let fall = is_seen.then(|| (shelf / beyond[counted - 1].max(f64::MIN_POSITIVE)).log10());
            // An exponential that sinks so much over the outer half of the distance sinks by this much from there to the end.
            let own = sinks * (end - at.frequency) / (HALF * distance);
            fall.is_some_and(|fall| fall > decades + further && fall > own)
        };
        FALLS.iter().any(falls).then_some(shelf)
    };
    let (at, shelf) = within(from, REACH * peak).find_map(|at| Some((at, shelf_that_falls(at)?)))?;
    // Noise dips here and there: the edge stands behind the last band that is still up.
    let last = within(at.frequency, WIDEST * at.frequency).rfind(|s| s.power >= EDGE * shelf)?;
    steps.iter().find(|s| s.frequency > last.frequency).map(|s| s.frequency)
}
