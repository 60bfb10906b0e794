//! Defects of a record: clipped peaks, a tail that was cut off and filled up with equal samples or that holds nothing but noise, and the noise itself.

use std::ops::Range;

/// Equal samples in a row at an extreme value of the record that count as clipped. Two occur by chance at the crests of a finely sampled
/// sinusoid.
const CLIPPED_RUN: usize = 3;
/// Least number of places with such runs in a clipped record: a digitised crest can be flat once.
const CLIPPED_PLACES: usize = 2;

/// Number of blocks in which the energy of a record is followed. A decay that fills less than one of them, a four-hundredth of the record, is not seen.
const BLOCKS: usize = 400;
/// The loudest block must have this many times the energy of the tail (20 dB), else the record is not cut: the decay is then not much more than the noise.
const LOUD: f64 = 100.0;
/// The decay is over at the first two successive blocks that have less than this many times the tail's energy. Half this value is the tail itself; twice this value
/// would end the decay a third of an e-fold earlier.
const GONE: f64 = 2.0;
/// A later block with this many times the tail's energy is not noise, and the record is left as it is. Noise in a narrow band reaches this once in many thousand blocks.
const ANEW: f64 = 20.0;
/// The record is cut this many lengths of the decay behind its loudest block, so that some noise is seen behind the decay.
const STAYS: f64 = 1.5;
/// The record is cut only where less than this fraction of it is kept; of a longer decay spectra and curves see enough.
const SHORT: f64 = 0.25;

/// Coefficients of twelfth differences. They leave a millionth of a mode of twenty samples a cycle and a thousandth of one of ten, and enlarge the standard deviation of
/// noise 1,600 times.
const DIFFERENCES: [f64; 13] =
    [1.0, -12.0, 66.0, -220.0, 495.0, -792.0, 924.0, -792.0, 495.0, -220.0, 66.0, -12.0, 1.0];
/// Median of the magnitude of a normal variable, in standard deviations.
const MEDIAN: f64 = 0.6745;

/// Standard deviation of the noise in samples of a vibration (in their unit), from the median magnitude of their twelfth differences. The median is taken because a
/// stiffness that changes now and then, as when sliders begin to slip, disturbs few of the differences. Below ten samples a cycle of the highest mode the vibration itself
/// counts as noise. None for fewer than 13 samples, which the differences need.
pub(crate) fn sample_noise(x: &[f64]) -> Option<f64> {
    let difference = |w: &[f64]| w.iter().zip(DIFFERENCES).map(|(x, c)| x * c).sum::<f64>().abs();
    let mut all: Vec<f64> = x.windows(DIFFERENCES.len()).map(difference).collect();
    let middle = all.len() / 2;
    let enlarged = DIFFERENCES.iter().map(|c| c * c).sum::<f64>().sqrt();
    (!all.is_empty()).then(|| *all.select_nth_unstable_by(middle, f64::total_cmp).1 / (MEDIAN * enlarged))
}

/// Runs of equal samples, at least `shortest` long.
fn runs(x: &[f64], shortest: usize) -> impl Iterator<Item = Range<usize>> + '_ {
    let mut from = 0;
    (1..=x.len()).filter_map(move |i| {
        if i < x.len() && x[i] == x[from] {
            return None;
        }
        let run = from..i;
        from = i;
        (run.len() >= shortest).then_some(run)
    })
}

/// The first sample behind the last clipped one; none where the record is not clipped.
pub(crate) fn clipped_until(x: &[f64]) -> Option<usize> {
    clipped_runs(x).last().map(|run| run.end)
}

/// The runs of clipped samples: those where the largest or the smallest value of the record stands three times in a row. Empty where there are fewer than two such places.
pub(super) fn clipped_runs(x: &[f64]) -> Vec<Range<usize>> {
    let rails = x.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(*v), b.max(*v)));
    if rails.0 >= rails.1 {
        return Vec::new();
    }
    let at_rail = |run: &Range<usize>| x[run.start] == rails.0 || x[run.start] == rails.1;
    let found: Vec<Range<usize>> = runs(x, CLIPPED_RUN).filter(at_rail).collect();
    if found.len() < CLIPPED_PLACES { Vec::new() } else { found }
}

/// Where the record really ends: the start of the first run of `longest` (at least 8) equal samples that ends more than `longest` samples behind the largest sample.
pub(crate) fn stops_at(x: &[f64], longest: usize) -> Option<usize> {
    let top = (0..x.len()).max_by(|&i, &j| x[i].abs().total_cmp(&x[j].abs()))?;
    runs(x, longest.max(8)).find(|run| run.end > top + longest).map(|run| run.start)
}

/// The sample at which a record may be cut because its decay is over in a small part of it; some noise behind the decay is kept. The energy is
/// followed in blocks of at least `least` samples. None where the part kept would fill a quarter of the record, where the tail is not quiet, or where nothing rises above it.
pub(super) fn gone_by(x: &[f64], least: usize) -> Option<usize> {
    let length = (x.len() / BLOCKS).max(least).max(8);
    let energy = |block: &[f64]| {
        let mean = block.iter().sum::<f64>() / block.len() as f64;
        block.iter().map(|x| (x - mean).powi(2)).sum::<f64>()
    };
    let all: Vec<f64> = x.chunks_exact(length).map(energy).collect();
    let mut tail = all[all.len() / 2..].to_vec();
    let middle = tail.len() / 2;
    (middle > 0).then_some(())?;
    let floor = *tail.select_nth_unstable_by(middle, f64::total_cmp).1;
    let loudest = (0..all.len()).max_by(|&i, &j| all[i].total_cmp(&all[j]))?;
    (all[loudest] > LOUD * floor).then_some(())?;
    let sunk = |pair: &[f64]| pair.iter().all(|e| *e < GONE * floor);
    let gone = loudest + all[loudest..].windows(2).position(sunk)?;
    let end = loudest + (STAYS * (gone - loudest) as f64).ceil() as usize + 1;
    let quiet = all[gone..].iter().all(|e| *e < ANEW * floor);
    (quiet && (end as f64) < SHORT * all.len() as f64).then_some(end * length)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_told_from_the_vibration() {
        let mut random = iwan_core::SplitMix64::new(5);
        // Uniform noise between -h and h has the standard deviation h/√3.
        let mut with = |h: f64| -> Vec<f64> {
            (0..4000).map(|n| (0.3 * f64::from(n)).cos() + h * random.next_symmetric()).collect()
        };
        let deviation = 1e-3 / 3.0_f64.sqrt();
        let found = sample_noise(&with(1e-3)).unwrap();
        assert!((found / deviation - 1.0).abs() < 0.1, "{found:e}");
        assert!(sample_noise(&with(0.0)).unwrap() < 1e-9);
        assert_eq!(sample_noise(&[0.0; 12]), None);
    }

    fn decay(n: usize) -> f64 {
        (-1e-3 * n as f64).exp() * (0.2 * n as f64).sin()
    }

    #[test]
    fn clipping_is_told_from_a_flat_crest() {
        let clean: Vec<f64> = (0..2000).map(decay).collect();
        let clipped: Vec<f64> = clean.iter().map(|x| x.clamp(-0.6, 0.7)).collect();
        assert_eq!(clipped_until(&clean), None);
        let until = clipped_until(&clipped).unwrap();
        assert!((clean[until..].iter().all(|x| x.abs() < 0.7)) && until < 600);
        let mut flat = clean;
        flat[7] = 1.5;
        flat[8] = 1.5;
        flat[9] = 1.5;
        assert_eq!(clipped_until(&flat), None);
        assert_eq!(clipped_until(&[0.0; 50]), None);
    }

    #[test]
    fn a_short_decay_is_told_from_the_noise_behind_it() {
        let mut random = iwan_core::SplitMix64::new(9);
        let mut with = |rate: f64, second: f64| -> Vec<f64> {
            let wave = |n: f64| if n < 0.0 { 0.0 } else { (-rate * n).exp() * (0.2 * n).sin() };
            let at = |n: f64| wave(n - 500.0) + second * wave(n - 30_000.0);
            (0..40_000).map(|n| at(f64::from(n)) + 0.01 * random.next_symmetric()).collect()
        };
        // From the sample 500 on the amplitude e^(-n/300) sinks to the noise of 0.0058 within 1,440 samples.
        let end = gone_by(&with(1.0 / 300.0, 0.0), 64).unwrap();
        assert!((2_000..3_500).contains(&end), "{end}");
        assert_eq!(gone_by(&with(1.0 / 300.0, 0.5), 64), None);
        assert_eq!(gone_by(&with(1e-4, 0.0), 64), None);
        assert_eq!(gone_by(&with(1.0, 0.0)[600..], 64), None);
        assert_eq!(gone_by(&[0.0; 100], 64), None);
    }

    #[test]
    fn a_filled_up_tail_is_found_and_a_quiet_start_is_not() {
        let mut x: Vec<f64> = (0..2000).map(decay).collect();
        assert_eq!(stops_at(&x, 16), None);
        x[1500..].fill(0.0);
        assert_eq!(stops_at(&x, 16), Some(1500));
        let mut late = vec![0.0; 500];
        late.extend((0..1000).map(decay));
        assert_eq!(stops_at(&late, 16), None);
    }
}
