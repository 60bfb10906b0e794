//! Hits in a record: where a vibration is driven anew.

use std::ops::Range;

use super::ring::{RingSpectrum, Window};
use super::swing::{driven_until, largest_swing, quantile, swing};
use crate::error::Error;
use crate::signal::defects::clipped_until;

/// Samples a cycle of the strongest peak at which hits are looked for: a record with more is averaged to as many (coarse) samples. Ten and forty find the
/// same hits.
const PER_CYCLE: f64 = 20.0;
/// Order of the linear prediction, enough for sixteen modes. Order 16 leaves more beside a second hit, order 64 finds the same hits.
const ORDER: usize = 32;
/// Number of coarse samples on either side of a sample of which the median prediction error is taken.
const AROUND: usize = 200;
/// Samples next to a sample that these medians leave out, because the hit itself is in them.
const GUARD: usize = 2 * ORDER;
/// Least number of samples before a hit that begins in the first ORDER samples of a record.
const SHORTEST: usize = 8;
/// Such a hit is told only where the samples before it stay below this fraction of the amplitude that follows.
const SILENCE: f64 = 0.1;
/// A sample is driven when its prediction error is at least this many medians of the errors around it: 8 standard deviations of normal noise.
const MEDIANS: f64 = 12.0;
/// The error of a driven sample is also at least this fraction of the amplitude that follows; less is drift of the frequency, which the prediction does not know.
const PART: f64 = 5e-3;
/// The error is also at least this fraction of the largest amplitude of the record: smaller hits are of no use and no harm.
const LOUD: f64 = 2e-3;
/// The error is also at least this many steps between the numbers that the record can hold: where a decay sinks into the last bit of a converter, errors of one step stand
/// among zeros, and the prediction of a cycle in few samples weighs the rounding of several of them.
const STEPS: f64 = 4.0;
/// A driven sample belongs to the hit before it unless at least this many samples between them are not driven: half a cycle.
const QUIET: usize = 10;
/// Within ORDER samples after a hit, the memory of the prediction, no other hit is told. Within the next CYCLES cycles only errors of at least this fraction of the hit's own
/// count: smaller ones are what the prediction, or a joint that rattles, makes of the hit itself.
const ECHO: f64 = 0.05;
/// Within these cycles an error must also be this many times the median error of the samples just before.
const ANEW: f64 = 8.0;
/// Number of samples before an error of which that median is taken: a cycle.
const RECENT: usize = 23;
/// A hit begins a stretch of its own when the swing rises by at least this factor from the cycle before to the two cycles behind.
const RISE: f64 = 1.5;
/// Least number of cycles between the starts of two stretches: an envelope needs as many. Where hits follow each other sooner, a later one behind which the swing is larger by
/// RISE begins the stretch instead.
const CYCLES: f64 = 20.0;
/// A lead-in (see [`Hit::lead_in`]) leaves the zero line of the decay behind it by at least this fraction of the decay's swing: less is noise, or a hand that finds its place.
const LEAD_IN: f64 = 0.2;

/// A stretch of a record that begins with a hit, up to the next hit or the end of the record.
#[derive(Debug, Clone, PartialEq)]
pub struct Hit {
    /// Samples of the stretch, the hit's first driven sample included.
    pub samples: Range<usize>,
    /// Time of the hit, s from the first sample of the record.
    pub time: f64,
    /// Largest deviation from the record's mean within two cycles of the hit, in the unit of the record.
    pub peak: f64,
    /// Whether this is the first hit and the record before it is a lead-in, neither quiet nor a free decay: the structure is pulled, held and let go, or handled, or driven at
    /// a resonance until the force is taken away.
    pub lead_in: bool,
    /// Times (s from the first sample of the record) at which the stretch is driven again, too early or too weakly to begin a stretch:
    /// a double hit, or another disturbance.
    pub again: Vec<f64>,
}

/// The hits in a record of any unit, sampled every `dt` seconds. The list is empty where nothing is driven: in noise, or in a free decay from the first
/// sample on. A free decay before the first hit is a stretch of its own.
///
/// A lead-in, in which the structure is pulled, held, handled or driven at constant amplitude before it is let go, is no stretch.
///
/// A free vibration of any number of modes, beats and all, follows from its past by linear prediction (of order 32, by Burg's method, at
/// twenty samples a cycle of the strongest peak). The structure is driven where the prediction error is far larger than around, and at least a certain part of the
/// amplitude that follows.
///
/// # Errors
/// [`Error::OutOfRange`] for `dt`, [`Error::NotFinite`], [`Error::TooShort`] below 64 samples.
///
/// ```
/// let decay = |n: usize| (-4e-3 * n as f64).exp() * (0.6 * n as f64).sin();
/// let from = |n: usize, start: usize| if n < start { 0.0 } else { decay(n - start) };
/// let x: Vec<f64> = (0..4000).map(|n| from(n, 300) + 0.7 * from(n, 2100)).collect();
/// let hits = iwan_ident::signal::hits(&x, 1e-3)?;
/// assert_eq!(hits.len(), 2);
/// assert!((hits[0].time - 0.3).abs() < 3e-3 && (hits[1].time - 2.1).abs() < 3e-3 && hits[1].again.is_empty());
/// # Ok::<(), iwan_ident::Error>(())
/// ```
pub fn hits(x: &[f64], dt: f64) -> Result<Vec<Hit>, Error> {
    let spectrum = RingSpectrum::new(&[x], dt, Window::Falling)?;
    let first = (4.0 / spectrum.length / spectrum.step) as usize + 1;
    let lines = first..spectrum.power.len();
    let top = lines.max_by(|&i, &j| spectrum.power[i].total_cmp(&spectrum.power[j])).unwrap_or(first);
    let frequency = top as f64 * spectrum.step;
    let few = (1.0 / (PER_CYCLE * frequency * dt)).floor().max(1.0) as usize;
    let mean = x.iter().sum::<f64>() / x.len() as f64;
    let coarse: Vec<f64> = x.chunks_exact(few).map(|c| c.iter().sum::<f64>() / few as f64 - mean).collect();
    let cycle = ((1.0 / (frequency * dt * few as f64)).ceil() as usize).max(2);
    let onsets = onsets(&coarse, cycle, step_of(x));
    let scale = Scale { few, dt, cycle };
    Ok(scale.stretches(x, mean, &coarse, &onsets))
}

/// Scale of the coarse samples, each of which is the mean of several samples of the record.
struct Scale {
    /// Samples of the record in each coarse sample.
    few: usize,
    dt: f64,
    /// Coarse samples in a cycle.
    cycle: usize,
}

impl Scale {
    fn time(&self, onset: usize) -> f64 {
        (onset * self.few) as f64 * self.dt
    }

    /// The stretches of the record `x` that the onsets begin, with the onsets within each.
    fn stretches(&self, x: &[f64], mean: f64, coarse: &[f64], onsets: &[usize]) -> Vec<Hit> {
        let least = (CYCLES * self.cycle as f64) as usize;
        let behind = |onset: usize| swing(coarse, onset..onset + 2 * self.cycle);
        let rises =
            |onset: usize| behind(onset) >= RISE * swing(coarse, onset.saturating_sub(self.cycle)..onset);
        // Where each stretch begins, and where the one before it ends.
        let mut starts: Vec<usize> = Vec::new();
        let mut ends: Vec<usize> = Vec::new();
        for &onset in onsets.iter().filter(|onset| coarse.len() - **onset >= least && rises(**onset)) {
            match starts.last_mut().filter(|last| onset - **last < least) {
                None => {
                    starts.push(onset);
                    ends.push(onset);
                }
                // The blow of one hit has several onsets.
                Some(last) if behind(onset) >= RISE * behind(*last) => *last = onset,
                Some(_) => {}
            }
        }
        let decays_before = |first: usize| {
            let third = |n: usize| largest_swing(&coarse[n * first / 3..(n + 1) * first / 3], self.cycle);
            third(0) > 3.0 * third(2) && third(0) > 0.1 * largest_swing(&coarse[first..], self.cycle)
        };
        let mut lead_in = None;
        if let Some(&first) = starts.first() {
            if first >= least && decays_before(first) {
                starts.insert(0, 0);
                ends.insert(0, 0);
            } else {
                let zero = quantile(&coarse[first..], 0.5);
                // What the blow itself moves before its onset is found is no lead-in.
                let before = &coarse[..first.saturating_sub(self.cycle)];
                let away = before.iter().map(|x| (x - zero).abs()).fold(0.0, f64::max);
                lead_in = Some(first).filter(|_| away > LEAD_IN * behind(first));
            }
        }
        // A clipped decay is as steady as a tone, so tones are looked for only in records that are not clipped.
        if clipped_until(x).is_none() {
            lead_in = self.without_tones(coarse, &mut starts, &mut ends).or(lead_in);
        }
        let hit = |(n, &start): (usize, &usize)| {
            let end = ends.get(n + 1).map_or(x.len(), |next| next * self.few);
            let within = |o: &&usize| **o > start && **o * self.few < end;
            let from = start * self.few;
            let to = (from + 2 * self.cycle * self.few).min(end);
            Hit {
                samples: from..end,
                time: self.time(start),
                peak: x[from..to].iter().map(|x| (x - mean).abs()).fold(0.0, f64::max),
                lead_in: lead_in == Some(start),
                again: onsets.iter().filter(within).map(|o| self.time(*o)).collect(),
            }
        };
        starts.iter().enumerate().map(hit).collect()
    }

    /// Lets stretches in which a tone is driven begin where the tone ends; a record without hits may be such a stretch. Returns the new start of the first stretch, if it was
    /// moved.
    fn without_tones(&self, coarse: &[f64], starts: &mut Vec<usize>, ends: &mut Vec<usize>) -> Option<usize> {
        let least = (CYCLES * self.cycle as f64) as usize;
        let (begins, stops) =
            if starts.is_empty() { (vec![0], vec![0]) } else { (starts.clone(), ends.clone()) };
        let released = |(n, begin): (usize, &usize)| {
            let part = &coarse[*begin..stops.get(n + 1).copied().unwrap_or(coarse.len())];
            driven_until(part, self.cycle).filter(|end| part.len() - end >= least).map(|end| begin + end)
        };
        let released: Vec<Option<usize>> = begins.iter().enumerate().map(released).collect();
        let first = released[0];
        if let (true, Some(first)) = (starts.is_empty(), first) {
            (*starts, *ends) = (vec![first], vec![first]);
        } else {
            starts.iter_mut().zip(&released).for_each(|(start, end)| *start = end.unwrap_or(*start));
        }
        first
    }
}

fn largest(x: &[f64], from: usize, to: usize) -> f64 {
    x[from.min(x.len())..to.min(x.len())].iter().map(|x| x.abs()).fold(0.0, f64::max)
}

/// The smallest difference of two neighbouring samples that is not zero: one step of the converter where a record has few digits, and next to nothing where it has many.
fn step_of(x: &[f64]) -> f64 {
    x.windows(2).map(|w| (w[1] - w[0]).abs()).filter(|d| *d > 0.0).fold(f64::INFINITY, f64::min)
}

/// Coarse samples at which the vibration begins to be driven. A cycle is `cycle` coarse samples; the record goes in steps of `step`.
fn onsets(x: &[f64], cycle: usize, step: f64) -> Vec<usize> {
    if x.len() < 4 * ORDER {
        return Vec::new();
    }
    let error = prediction_error(x);
    let (medians, top) = (block_medians(&error), largest(x, 0, x.len()));
    let usual = |i: usize| {
        let before = i.checked_sub(GUARD).map(|j| medians[j / AROUND]);
        let after = medians.get((i + GUARD).div_ceil(AROUND)).copied();
        // A louder part beside a quiet one has larger errors throughout: the smaller median is that of the quiet part, so the larger one is taken.
        before.unwrap_or(0.0).max(after.unwrap_or(0.0))
    };
    let driven = |i: usize| {
        let follows = largest(x, i, i + cycle);
        let e = error[i].abs();
        e > MEDIANS * usual(i) && e > PART * follows && e > LOUD * top && e > STEPS * step
    };
    let mut found: Vec<usize> = Vec::new();
    let (mut last, mut strongest) = (None::<usize>, 0.0_f64);
    // Before the prediction has all the samples it needs, a hit is told only where it follows silence: a free decay may begin with the record.
    let told = |i: &usize| *i >= ORDER || largest(x, 0, *i) < SILENCE * largest(x, *i, i + cycle);
    for i in (SHORTEST..x.len()).filter(|i| told(i) && driven(*i)) {
        let e = error[i].abs();
        let near = last.is_some_and(|last| i - last <= QUIET);
        let since = found.last().map_or(x.len(), |first| i - first);
        let soon = since <= (CYCLES * cycle as f64) as usize;
        let before = median_of(&error[i.saturating_sub(RECENT)..i.saturating_sub(3)]);
        let echo = since <= ORDER || soon && (e < ECHO * strongest || e < ANEW * before);
        if !near && !echo {
            found.push(i);
            strongest = 0.0;
        }
        if near || !echo {
            last = Some(i);
            strongest = strongest.max(e);
        }
    }
    found
}

/// Median of |error|; 0 of nothing.
fn median_of(error: &[f64]) -> f64 {
    quantile(&error.iter().map(|e| e.abs()).collect::<Vec<f64>>(), 0.5)
}

/// Median of |error| in each block.
fn block_medians(error: &[f64]) -> Vec<f64> {
    error.chunks(AROUND).map(median_of).collect()
}

/// Error of the linear prediction of each sample from the samples before it; the first ones are predicted from as many as there are. Coefficients by Burg's method (J. P. Burg,
/// *Maximum Entropy Spectral Analysis*, 1975), which keeps the prediction stable.
fn prediction_error(x: &[f64]) -> Vec<f64> {
    let n = x.len();
    let (mut forward, mut backward) = (x.to_vec(), x.to_vec());
    for m in 1..=ORDER {
        let (mut product, mut power) = (0.0, 0.0);
        for i in m..n {
            product += forward[i] * backward[i - 1];
            power += forward[i] * forward[i] + backward[i - 1] * backward[i - 1];
        }
        if power <= f64::MIN_POSITIVE {
            break;
        }
        let k = 2.0 * product / power;
        for i in (m..n).rev() {
            let f = forward[i];
            forward[i] -= k * backward[i - 1];
            backward[i] = backward[i - 1] - k * f;
        }
    }
    forward
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    const RATE: f64 = 5120.0;

    /// Two modes released at a time, with the pulse of a hammer of 1 ms.
    fn struck(at: f64, size: f64) -> impl Fn(f64) -> f64 {
        move |t: f64| {
            let s = t - at;
            let mode = |f: f64, z: f64| (-TAU * f * z * s).exp() * (TAU * f * s).sin();
            let rise = (s / 1e-3).clamp(0.0, 1.0);
            if s < 0.0 { 0.0 } else { size * rise * (mode(122.4, 3e-3) + 0.4 * mode(243.4, 2e-3)) }
        }
    }

    fn noise(n: usize, size: f64) -> Vec<f64> {
        let mut state = 7_u64;
        let mut uniform = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..n).map(|_| size * (-2.0 * uniform().max(1e-300).ln()).sqrt() * (TAU * uniform()).cos()).collect()
    }

    fn record(parts: &[&dyn Fn(f64) -> f64], seconds: f64, scatter: f64) -> Vec<f64> {
        let n = (seconds * RATE) as usize;
        let sum = |i: usize| parts.iter().map(|part| part(i as f64 / RATE)).sum::<f64>();
        noise(n, scatter).iter().enumerate().map(|(i, e)| sum(i) + e).collect()
    }

    #[test]
    fn three_hits_are_three_stretches() {
        let (a, b, c) = (struck(0.1, 1.0), struck(1.2, 0.6), struck(2.5, 1.3));
        for scatter in [0.0, 1e-3, 1e-2] {
            let found = hits(&record(&[&a, &b, &c], 4.0, scatter), 1.0 / RATE).unwrap();
            let times: Vec<f64> = found.iter().map(|h| h.time).collect();
            assert_eq!(times.len(), 3, "{scatter}: {found:?}");
            assert!(times.iter().zip([0.1, 1.2, 2.5]).all(|(t, at)| (t - at).abs() < 3e-3), "{times:?}");
            assert!(found.iter().all(|h| h.again.is_empty()), "{scatter}: {found:?}");
            assert_eq!((found[0].samples.end, found[2].samples.end), (found[1].samples.start, 20_480));
        }
    }

    #[test]
    fn a_double_hit_is_named_with_its_time() {
        for (size, scatter) in [(0.1, 0.0), (0.1, 1e-4), (0.3, 1e-3), (0.8, 1e-2)] {
            let (a, b) = (struck(0.1, 1.0), struck(0.12, size));
            let found = hits(&record(&[&a, &b], 2.0, scatter), 1.0 / RATE).unwrap();
            assert_eq!(found.len(), 1, "{size}: {found:?}");
            assert_eq!(found[0].again.len(), 1, "{size}: {found:?}");
            assert!((found[0].again[0] - 0.12).abs() < 3e-3, "{size}: {found:?}");
        }
    }

    /// Pulled to -1 in half a second, held for another by an unsteady hand, and let go.
    fn let_go(t: f64) -> f64 {
        let held = |t: f64| 0.05 * (TAU * 3.1 * t).sin() * (TAU * 0.7 * t).cos();
        match t {
            t if t < 0.5 => 0.0,
            t if t < 1.0 => -2.0 * (t - 0.5),
            t if t < 1.5 => -1.0 + held(t - 1.0),
            t => -(-0.4 * (t - 1.5)).exp() * (TAU * 20.0 * (t - 1.5)).cos(),
        }
    }

    #[test]
    fn a_structure_that_is_let_go_rings_from_then_on() {
        for (scatter, offset) in [(0.0, 0.0), (1e-3, 35.0), (1e-2, -0.4)] {
            let released = |t: f64| offset + let_go(t);
            let found = hits(&record(&[&released], 8.0, scatter), 1.0 / RATE).unwrap();
            assert_eq!(found.len(), 1, "{scatter}: {found:?}");
            assert!(found[0].lead_in && (found[0].time - 1.5).abs() < 5e-3, "{scatter}: {found:?}");
        }
        // A quiet start is no lead-in.
        let found = hits(&record(&[&struck(0.5, 1.0)], 3.0, 1e-2), 1.0 / RATE).unwrap();
        assert!(found.len() == 1 && !found[0].lead_in, "{found:?}");
    }

    #[test]
    fn a_resonance_that_is_switched_off_rings_from_then_on() {
        let dwell = |t: f64| {
            let amplitude = if t < 2.0 { 1.0 - (-8.0 * t).exp() } else { (-3.0 * (t - 2.0)).exp() };
            amplitude * (TAU * 122.4 * t).sin()
        };
        let late = |t: f64| if t < 0.5 { 0.0 } else { dwell(t - 0.5) };
        for scatter in [1e-4, 1e-2] {
            for (wave, at) in [(&dwell as &dyn Fn(f64) -> f64, 2.0), (&late, 2.5)] {
                let found = hits(&record(&[wave], 5.0, scatter), 1.0 / RATE).unwrap();
                assert!(found.len() == 1 && found[0].lead_in, "{scatter}: {found:?}");
                assert!((found[0].time - at).abs() < 0.05, "{scatter}: {found:?}");
            }
        }
    }

    #[test]
    fn the_stronger_of_two_hits_near_each_other_begins_the_stretch() {
        let (a, b, c) = (struck(0.1, 1.0), struck(2.0, 0.1), struck(2.05, 1.0));
        let found = hits(&record(&[&a, &b, &c], 4.0, 1e-4), 1.0 / RATE).unwrap();
        assert_eq!(found.len(), 2, "{found:?}");
        assert!((found[1].time - 2.05).abs() < 3e-3, "{found:?}");
        // The decay before ends at the weaker one.
        assert!(
            (found[0].samples.end as f64 / RATE - 2.0).abs() < 3e-3 && found[0].again.is_empty(),
            "{found:?}"
        );
    }

    #[test]
    fn beats_noise_and_free_decays_are_no_hits() {
        let beat = |t: f64| {
            let mode = |f: f64| (-0.5 * t).exp() * (TAU * f * t).sin();
            mode(120.0) + mode(123.0)
        };
        let free = |t: f64| (-3.0 * t).exp() * (TAU * (100.0 * t - 2.0 * t * t)).cos();
        for scatter in [0.0, 1e-3, 3e-2] {
            assert_eq!(hits(&record(&[&beat], 4.0, scatter), 1.0 / RATE).unwrap(), [], "{scatter}");
            assert_eq!(hits(&record(&[&free], 3.0, scatter), 1.0 / RATE).unwrap(), [], "{scatter}");
        }
        assert_eq!(hits(&noise(30_000, 1.0), 1.0 / RATE).unwrap(), []);
        assert_eq!(hits(&[0.0; 500], 1.0 / RATE).unwrap(), []);
    }

    #[test]
    fn the_last_bits_of_a_converter_are_no_hits() {
        for bits in [8, 10, 12] {
            let full = f64::from(1 << (bits - 1)) - 1.0;
            let stored = |x: f64| (full * x).round() / full;
            let decay = |t: f64| stored((-8.0 * t).exp() * (TAU * 122.4 * t + 0.3).cos());
            assert_eq!(hits(&record(&[&decay], 3.0, 0.0), 1.0 / RATE).unwrap(), [], "{bits} bits");
            let hit = struck(0.1, 0.9);
            let hit = |t: f64| stored(hit(t));
            let found = hits(&record(&[&hit], 3.0, 0.0), 1.0 / RATE).unwrap();
            assert_eq!(found.len(), 1, "{bits} bits: {found:?}");
            assert_eq!(found[0].again, [] as [f64; 0], "{bits} bits");
        }
    }

    #[test]
    fn a_decay_before_the_first_hit_is_a_stretch() {
        let free = |t: f64| (-3.0 * t).exp() * (TAU * 122.4 * t).cos();
        let found = hits(&record(&[&free, &struck(2.0, 1.0)], 4.0, 1e-3), 1.0 / RATE).unwrap();
        assert_eq!(found.len(), 2, "{found:?}");
        assert_eq!(found[0].samples.start, 0);
        assert!((found[1].time - 2.0).abs() < 3e-3);
    }
}
