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
}
