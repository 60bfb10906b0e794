//! Breaks that no vibration makes: single wrong samples, and places where samples are missing.
//!
//! A vibration of eight samples a cycle and more follows the cubic through the four samples about each sample to some per cent. Where the deviation from that cubic has the
//! signature of one wrong sample or of a step, and nothing like it is nearby, it is no noise; and where the record is as loud before the place as behind it, it is no hit.

/// Weights of the neighbours, at one and at two samples' distance, in the cubic through the four of them.
const CUBIC: [f64; 2] = [4.0 / 6.0, -1.0 / 6.0];
/// Signature of one wrong sample: deviations from the cubic relative to the sample's error, from two samples before it to two behind it.
const LONE: [f64; 5] = [1.0 / 6.0, -4.0 / 6.0, 1.0, -4.0 / 6.0, 1.0 / 6.0];
/// Signature of a step from one sample to the next: deviations from the cubic relative to the step.
const STEP: [f64; 4] = [1.0 / 6.0, -0.5, 0.5, -1.0 / 6.0];
/// Least share of the sum of squares about a place that its signature explains.
const EXPLAINED: f64 = 0.9;
/// Samples on either side of the signature that have to be quiet.
const BESIDE: usize = 24;
/// The quiet samples' deviations are smaller by this factor than the largest in the signature. Of normal noise the largest of so many is 2.5 standard deviations: ten times
/// that never happens.
const QUIET: f64 = 10.0;
/// Length on either side of a break over which the largest samples are compared, in cycles of the slowest peak.
const CYCLES: f64 = 2.0;
/// Least number of samples of that length.
const LEAST: usize = 10 * BESIDE;
/// Largest ratio of the record's largest samples before and behind a break: behind a hit it is louder, and noise alone stays well below.
const LOUDER: f64 = 1.4;
/// Least size of a break, as a fraction of the largest sample: a wrong sample of a twentieth among thousands moves no curve.
const PART: f64 = 0.05;
/// Largest number of wild samples in a record. Where more are found, none is reported: what comes again and again belongs to the structure, as impacts and the steps of dry
/// friction.
const WILD: usize = 20;
/// The same for places with lost samples.
const LOST: usize = 3;

/// A place at which a signature stands out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Place {
    /// Index of the wrong sample, or of the first one behind a gap.
    pub(super) at: usize,
    /// How far the sample lies off its neighbours, or what the gap's two sides differ by, in the unit of the record.
    pub(super) size: f64,
    /// Share of the sum of squares there that the signature explains.
    explained: f64,
}

/// Wild samples, and places where samples are lost.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Breaks {
    pub(super) wild: Vec<Place>,
    pub(super) lost: Vec<Place>,
}

/// The breaks of a record whose slowest peak has `cycle` samples a cycle. A list is empty where it would hold more than a record has of its kind.
pub(super) fn breaks(x: &[f64], cycle: f64) -> Breaks {
    let reach = ((CYCLES * cycle) as usize).max(LEAST);
    let mean = x.iter().sum::<f64>() / x.len().max(1) as f64;
    let loud = |part: &[f64]| part.iter().map(|x| (x - mean).abs()).fold(0.0, f64::max);
    // The signature itself is left out: it has two samples on either side.
    let alike = |p: &Place| {
        let (before, behind) = (&x[..p.at - 2], &x[p.at + 3..]);
        let (a, b) =
            (loud(&before[before.len().saturating_sub(reach)..]), loud(&behind[..behind.len().min(reach)]));
        a.max(b) < LOUDER * a.min(b)
    };
    let places = |signature: &[f64]| standing_out(x, signature).into_iter().filter(alike).collect::<Vec<_>>();
    let (lone, steps) = (places(&LONE), places(&STEP));
    // The two signatures are alike: one that explains less than the other next to it is only the other's shadow.
    let without = |all: &[Place], others: &[Place], most: usize| -> Vec<Place> {
        let shadowed =
            |p: &Place| others.iter().any(|o| o.at.abs_diff(p.at) < BESIDE && o.explained > p.explained);
        let own: Vec<Place> = all.iter().copied().filter(|p| !shadowed(p)).collect();
        if own.len() > most { vec![] } else { own }
    };
    Breaks { wild: without(&lone, &steps, WILD), lost: without(&steps, &lone, LOST) }
}

/// Deviation of each sample, except the first two and the last two, from the cubic through its four neighbours.
fn left_over(x: &[f64]) -> Vec<f64> {
    let one = |w: &[f64]| w[2] - CUBIC[0] * (w[1] + w[3]) - CUBIC[1] * (w[0] + w[4]);
    x.windows(5).map(one).collect()
}

/// The places at which a signature stands out.
fn standing_out(x: &[f64], signature: &[f64]) -> Vec<Place> {
    let (left, least) = (left_over(x), PART * x.iter().map(|x| x.abs()).fold(0.0, f64::max));
    let norm: f64 = signature.iter().map(|s| s * s).sum();
    let size = |w: &[f64]| w.iter().zip(signature).map(|(l, s)| l * s).sum::<f64>() / norm;
    let peak = |part: &[f64]| part.iter().map(|l| l.abs()).fold(0.0, f64::max);
    let mut found = vec![];
    for (i, around) in left.windows(signature.len() + 2 * BESIDE).enumerate() {
        let (before, rest) = around.split_at(BESIDE);
        let (window, behind) = rest.split_at(signature.len());
        let (size, total) = (size(window), window.iter().map(|l| l * l).sum::<f64>());
        let explained = size * size * norm / total.max(f64::MIN_POSITIVE);
        if size.abs() > least
            && explained > EXPLAINED
            && peak(window) > QUIET * peak(before).max(peak(behind))
        {
            // The first deviation is that of the third sample, and both signatures have two samples before the place itself.
            found.push(Place { at: i + BESIDE + 4, size, explained });
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two modes, fifteen and nine samples a cycle, in noise.
    fn record() -> Vec<f64> {
        let mut random = iwan_core::SplitMix64::new(3);
        let mode = |n: f64, turn: f64, size: f64| size * (-4e-4 * n).exp() * (turn * n).cos();
        let one = |n: i32| mode(f64::from(n), 0.42, 1.0) + mode(f64::from(n), 0.7, 0.02);
        (0..6000).map(|n| if n < 500 { 0.0 } else { one(n - 500) } + 2e-3 * random.next_symmetric()).collect()
    }

    #[test]
    fn what_a_vibration_does_is_no_break() {
        let x = record();
        let none = |x: &[f64]| breaks(x, 15.0) == Breaks::default();
        assert!(none(&x));
        // Another hit during the decay, a clipped start and a fall to nothing.
        let again: Vec<f64> = (0..x.len()).map(|n| x[n] + if n < 3000 { 0.0 } else { x[n - 2500] }).collect();
        assert!(none(&again));
        let clipped: Vec<f64> = x.iter().map(|x| x.clamp(-0.7, 0.7)).collect();
        assert!(none(&clipped));
        // Dry friction takes steps of the acceleration at every turn.
        let friction: Vec<f64> = (0..4000)
            .map(|n| (0.1 * f64::from(n)).cos() + 0.2 * (0.1 * f64::from(n)).sin().signum())
            .collect();
        assert!(none(&friction));
        assert!(none(&[1.0; 3]));
    }

    #[test]
    fn wild_samples_are_told() {
        let mut x = record();
        x[2000] += 0.4;
        x[2500] -= 7.0;
        let Breaks { wild, lost } = breaks(&x, 15.0);
        assert_eq!(wild.iter().map(|p| p.at).collect::<Vec<_>>(), [2000, 2500]);
        assert!((wild[0].size - 0.4).abs() < 0.05 && (wild[1].size + 7.0).abs() < 0.05, "{wild:?}");
        assert_eq!(lost, []);
    }

    #[test]
    fn lost_samples_are_told() {
        let mut x = record();
        x.drain(1801..1806);
        let Breaks { wild, lost } = breaks(&x, 15.0);
        assert_eq!(lost.iter().map(|p| p.at).collect::<Vec<_>>(), [1801]);
        assert_eq!(wild, []);
    }
}
