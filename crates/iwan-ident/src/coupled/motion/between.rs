//! Between samples and steps: cubics through four neighbours.

/// Lagrange's weights of four values, one apart, for a place at the distance `s` behind the second of them.
fn cubic(s: f64) -> [f64; 4] {
    let (a, b, c, d) = (s + 1.0, s, s - 1.0, s - 2.0);
    [-b * c * d / 6.0, a * c * d / 2.0, -a * b * d / 2.0, a * b * c / 6.0]
}

/// A load at `steps` instants from each of its samples to the next, by a cubic through four samples. Straight lines would multiply the load's
/// spectrum by sinc²(π f dt), which takes off 0.9 % at 52 Hz sampled at 1 kHz.
#[must_use]
pub fn between_samples(force: &[f64], steps: usize) -> Vec<f64> {
    let at = |n: isize| usize::try_from(n).ok().and_then(|n| force.get(n)).copied().unwrap_or(0.0);
    let weights: Vec<[f64; 4]> = (0..steps).map(|i| cubic(i as f64 / steps as f64)).collect();
    let value = |i: usize| {
        let n = (i / steps).cast_signed();
        let of = |(k, weight): (usize, &f64)| weight * at(n - 1 + k.cast_signed());
        weights[i % steps].iter().enumerate().map(of).sum::<f64>()
    };
    (0..force.len() * steps).map(value).collect()
}

/// Interpolates to `samples` samples from rows that are every `every`th of them, by the cubic through the four rows about each sample; there are at least four rows
/// where `every` is more than one.
pub(in crate::coupled) fn at_samples(rows: &[f64], every: usize, samples: usize) -> Vec<f64> {
    if every == 1 {
        return rows[..samples].to_vec();
    }
    let weights = |first: f64| -> Vec<[f64; 4]> {
        (0..every).map(|i| cubic(first + i as f64 / every as f64)).collect()
    };
    // The first and the last interval have no row on their outer side, so their cubics lean inwards.
    let last = rows.len() - 2;
    let mut out = vec![0.0; (last + 1) * every + 1];
    let fill = |out: &mut [f64], rows: &[f64], weights: &[[f64; 4]]| {
        for (out, rows) in out.chunks_exact_mut(every).zip(rows.windows(4)) {
            for (x, w) in out.iter_mut().zip(weights) {
                *x = (w[0] * rows[0] + w[1] * rows[1]) + (w[2] * rows[2] + w[3] * rows[3]);
            }
        }
    };
    fill(&mut out[..every], rows, &weights(-1.0));
    fill(&mut out[every..last * every], rows, &weights(0.0));
    fill(&mut out[last * every..], &rows[last - 2..], &weights(1.0));
    out[(last + 1) * every] = rows[last + 1];
    out.truncate(samples);
    out
}

/// The interpolated samples of [`at_samples`] summed over blocks of `block` samples each, without making them: what a row adds to a block depends only on how far the block's
/// first sample lies behind a row.
pub(super) fn in_blocks(rows: &[f64], every: usize, block: usize, out: &mut [f64]) {
    let patterns: Vec<Vec<f64>> = (0..every).map(|phase| pattern(phase, every, block)).collect();
    let last = rows.len() - 4;
    for (b, out) in out.iter_mut().enumerate() {
        let (row, phase) = (b * block / every, b * block % every);
        let pattern = &patterns[phase];
        *out = match row.checked_sub(1).and_then(|first| rows.get(first..first + pattern.len())) {
            Some(rows) => pattern.iter().zip(rows).map(|(weight, row)| weight * row).sum(),
            // The first interval has no row on its outer side, nor has the last one: their cubics lean inwards.
            None => (b * block..(b + 1) * block)
                .map(|n| {
                    let first = (n / every).saturating_sub(1).min(last);
                    let weights = cubic(n as f64 / every as f64 - (first + 1) as f64);
                    weights.iter().zip(&rows[first..]).map(|(weight, row)| weight * row).sum::<f64>()
                })
                .sum(),
        };
    }
}

/// Weights of the rows, from the one before the block on, in the sum over a block that begins `phase` samples behind a row.
fn pattern(phase: usize, every: usize, block: usize) -> Vec<f64> {
    let mut weights = vec![0.0; (phase + block - 1) / every + 4];
    for place in phase..phase + block {
        let own = cubic((place % every) as f64 / every as f64);
        weights[place / every..].iter_mut().zip(own).for_each(|(weight, own)| *weight += own);
    }
    weights
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_between_rows_are_those_of_a_cubic() {
        let cubic = |t: f64| 1.0 - t * (0.5 - t * (0.3 + 0.02 * t));
        for (every, samples) in [(2_i32, 18), (3, 26), (5, 37)] {
            let rows: Vec<f64> = (0..10).map(|n| cubic(f64::from(n * every))).collect();
            let found = at_samples(&rows, every as usize, samples);
            assert_eq!(found.len(), samples);
            for (n, x) in found.iter().enumerate() {
                let expected = cubic(n as f64);
                assert!(
                    (x - expected).abs() < 1e-12 * expected.abs().max(1.0),
                    "{every} {n}: {x} {expected}"
                );
            }
        }
        // Forty rows a period.
        let wave = |n: usize| (std::f64::consts::TAU * n as f64 / (3.0 * 40.0)).sin();
        let rows: Vec<f64> = (0..100).map(|n| wave(3 * n)).collect();
        let found = at_samples(&rows, 3, 298);
        let worst = (3..295).map(|n| (found[n] - wave(n)).abs()).fold(0.0, f64::max);
        assert!(worst < 2e-5, "{worst}");
    }

    #[test]
    fn sums_over_blocks_are_those_of_the_samples_between_rows() {
        for (every, block, samples) in [(3, 11, 298_usize), (2, 3, 100), (5, 2, 97), (3, 3, 50), (4, 40, 200)]
        {
            let count = (samples - 1).div_ceil(every) + 1;
            let rows: Vec<f64> = (0..count).map(|n| (0.3 * n as f64).sin() + 0.1 * n as f64).collect();
            let found = at_samples(&rows, every, samples);
            let mut sums = vec![0.0; samples / block];
            in_blocks(&rows, every, block, &mut sums);
            for (sum, samples) in sums.iter().zip(found.chunks_exact(block)) {
                let expected: f64 = samples.iter().sum();
                assert!((sum - expected).abs() < 1e-11 * block as f64, "{every} {block}: {sum} {expected}");
            }
        }
    }
}
