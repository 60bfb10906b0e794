//! The amplitude of a vibration from cycle to cycle, and where a vibration at constant amplitude ends.

use std::ops::Range;

/// Quantiles between which the swing is taken: a sinusoid keeps 95 % of its amplitude between them, and two wild samples of twenty do not count.
const QUANTILES: (f64, f64) = (0.1, 0.9);
/// Cycles over which swings are smoothed by their median: noise of 10 % then leaves 2 % of the amplitude.
const SMOOTHED: usize = 5;
/// A vibration is steady while its amplitude stays above this fraction of its largest.
const STEADY: f64 = 0.95;
/// The decay behind it is timed from STEADY down to this fraction of the largest amplitude.
const FALLEN: f64 = 0.8;
/// Least number of cycles for which the vibration is steady.
const CYCLES: usize = 10;
/// The vibration is also steady for longer than this many times what its decay takes from STEADY to FALLEN. A free decay of constant damping ratio takes three times as long
/// for that fall as it stays above STEADY, one by dry friction too; a beat stays above for twice as long as it takes to fall.
const LONGER: usize = 3;

/// An amplitude has turned when it has fallen to this part of its last high, or when its last low is this part of it.
const HALF: f64 = 0.5;
/// Highs that count reach this part of the largest amplitude: those of noise behind a decay are lower.
const RISEN: f64 = 0.3;
/// They reach this part of the high before: the beats of two modes that decay fall further.
const STILL: f64 = 0.9;
/// A rise is sudden if it takes the middle half of its way within so many cycles: a step is spread over three by the median, and a blow lasts a cycle or two.
const SUDDEN: usize = 5;

/// The value below which a fraction `part` of all values lies; 0 where there are none.
pub(super) fn quantile(x: &[f64], part: f64) -> f64 {
    let mut sorted = x.to_vec();
    let at = (part * x.len().saturating_sub(1) as f64).round() as usize;
    if sorted.is_empty() { 0.0 } else { *sorted.select_nth_unstable_by(at, f64::total_cmp).1 }
}

/// Half the distance between high and low values (QUANTILES) of some samples.
pub(super) fn swing(x: &[f64], samples: Range<usize>) -> f64 {
    let part = &x[samples.start.min(x.len())..samples.end.min(x.len())];
    0.5 * (quantile(part, QUANTILES.1) - quantile(part, QUANTILES.0))
}

/// The largest swing of any cycle.
pub(super) fn largest_swing(x: &[f64], cycle: usize) -> f64 {
    x.chunks(cycle).map(|one| swing(one, 0..one.len())).fold(0.0, f64::max)
}

/// The sample at which a vibration of constant amplitude, which somebody drives, goes over into a decay, as at a resonance that is driven until the force is taken away. None
/// where the samples hold no such vibration. A cycle is `cycle` samples.
pub(super) fn driven_until(x: &[f64], cycle: usize) -> Option<usize> {
    let swings: Vec<f64> = x.chunks_exact(cycle).map(|one| swing(one, 0..one.len())).collect();
    let smooth: Vec<f64> = swings.windows(SMOOTHED).map(|w| quantile(w, 0.5)).collect();
    let largest = smooth.iter().copied().fold(0.0, f64::max);
    let last = smooth.iter().rposition(|s| *s >= STEADY * largest)?;
    let steady = smooth[..=last].iter().rev().take_while(|s| **s >= STEADY * largest).count();
    let fall = smooth[last..].iter().position(|s| *s < FALLEN * largest)?;
    // The force ends where the decay, continued backwards, meets the steady amplitude: on a logarithmic scale the decay takes as long for each unit above STEADY as between
    // STEADY and FALLEN.
    let above = STEADY.ln() / (FALLEN / STEADY).ln() * fall as f64;
    let end = (last + SMOOTHED / 2).saturating_sub(above as usize) + 1;
    (steady >= CYCLES && steady > LONGER * fall).then_some(end * cycle)
}

/// How often the amplitude of a vibration with so many samples a `cycle` rises again, slowly, to a good part of its largest: what a blow makes is there within a few cycles. Once is a
/// resonance that builds up; a vibration that is driven all the time comes and goes.
pub(in crate::signal) fn slow_rises(x: &[f64], cycle: usize) -> usize {
    let swings: Vec<f64> = x.chunks_exact(cycle.max(1)).map(|one| swing(one, 0..one.len())).collect();
    let smooth: Vec<f64> = swings.windows(SMOOTHED).map(|w| quantile(w, 0.5)).collect();
    let least = RISEN * smooth.iter().copied().fold(0.0, f64::max);
    let is_slow = |low: usize, high: usize| {
        let level = |part: f64| smooth[low] + part * (smooth[high] - smooth[low]);
        let upper = (low..=high).find(|i| smooth[*i] >= level(0.75)).unwrap_or(high);
        let lower = (low..upper).rev().find(|i| smooth[*i] <= level(0.25)).unwrap_or(low);
        upper - lower > SUDDEN
    };
    // The high before the last low: beats of a decay are lower each time.
    let mut before = 0.0;
    let counts =
        |low: usize, high: usize, before: f64| smooth[high] > least.max(STILL * before) && is_slow(low, high);
    let (mut rises, mut low, mut high) = (0, 0, 0);
    // Going up from the last low to a new high, or down from that to a new low.
    let mut up = true;
    for (i, now) in smooth.iter().enumerate() {
        if up && *now > smooth[high] {
            high = i;
        } else if !up && *now < smooth[low] {
            low = i;
        } else if up && HALF * smooth[high] > *now {
            rises += usize::from(counts(low, high, before));
            (up, low, before) = (false, i, smooth[high]);
        } else if !up && HALF * now > smooth[low] {
            (up, high) = (true, i);
        }
    }
    rises + usize::from(up && high > low && counts(low, high, before))
}

#[cfg(test)]
mod tests {
    use super::*;

    const CYCLE: usize = 20;

    fn wave(amplitude: impl Fn(f64) -> f64) -> Vec<f64> {
        let turn = std::f64::consts::TAU / CYCLE as f64;
        (0..8000).map(|n| amplitude(f64::from(n)) * (turn * f64::from(n) + 0.4).sin()).collect()
    }

    #[test]
    fn a_tone_that_is_switched_off_is_told_from_decays_and_beats() {
        for rate in [5e-4, 2e-3, 1e-2] {
            let switched_off = wave(|n| (-rate * (n - 4000.0).max(0.0)).exp());
            let end = driven_until(&switched_off, CYCLE).unwrap();
            assert!(end.abs_diff(4000) <= 5 * CYCLE, "{rate}: {end}");
            assert_eq!(driven_until(&wave(|n| (-rate * n).exp()), CYCLE), None, "{rate}");
        }
        assert_eq!(driven_until(&wave(|_| 1.0), CYCLE), None);
        assert_eq!(driven_until(&wave(|n| (1.0 - n / 8000.0).max(0.0)), CYCLE), None, "dry friction");
        assert_eq!(driven_until(&wave(|n| (n / 1200.0).cos()), CYCLE), None, "a beat");
    }

    #[test]
    fn amplitudes_that_come_and_go_are_told_from_blows() {
        // From one low of the beat to the next are 400 cycles of twenty samples over two.
        assert_eq!(slow_rises(&wave(|n| (std::f64::consts::TAU * n / 4000.0).sin()), CYCLE), 4);
        assert_eq!(slow_rises(&wave(|n| 1.0 - (-1e-3 * n).exp()), CYCLE), 1, "a resonance that builds up");
        assert_eq!(slow_rises(&wave(|n| (-1e-3 * n).exp()), CYCLE), 0);
        let hits = wave(|n| if n < 500.0 { 1e-3 } else { (-2e-3 * ((n - 500.0) % 2500.0)).exp() });
        assert_eq!(slow_rises(&hits, CYCLE), 0);
        let beats = wave(|n| (-2e-4 * n).exp() * (std::f64::consts::TAU * n / 4000.0).sin());
        assert_eq!(slow_rises(&beats, CYCLE), 1, "beats of a decay");
        assert_eq!(slow_rises(&[], CYCLE), 0);
    }
}
