//! Where a free decay begins.

/// A sample of at least this fraction of the largest counts as the largest: with sixteen samples a cycle or more the highest sample of a peak reaches it.
const AS_LARGE: f64 = 0.98;

/// Time from a peak of a free decay to its next zero crossing, in cycles: a quarter of a cycle, somewhat less where a lower mode adds to it, more
/// where a joint softens in macro-slip. A half sine or a haversine a fifth of a cycle long falls in a tenth of a cycle and less, and such a peak is passed over.
const QUARTER: std::ops::RangeInclusive<f64> = 0.15..=0.45;

/// Index at which amplitudes first come near their largest: the peaks of a mode that hardly decays differ only by where samples meet them, so the largest may be a late one.
pub(super) fn first_of_the_largest(amplitudes: impl Iterator<Item = f64> + Clone) -> usize {
    let largest = amplitudes.clone().fold(0.0, f64::max);
    let first = amplitudes.clone().position(|x| x >= AS_LARGE * largest).unwrap_or(0);
    // Goes on from there to the top of that peak.
    let rising =
        amplitudes.clone().skip(first).zip(amplitudes.skip(first + 1)).take_while(|(x, next)| next > x);
    first + rising.count()
}

/// Index of the first peak from sample `peak` on that is followed by a quarter of a cycle of free decay, where a cycle is `cycle` samples. During the blow itself an
/// acceleration follows the force, and falls faster. `peak` itself where none is found within two cycles.
pub(super) fn behind_the_blow(x: &[f64], mean: f64, peak: usize, cycle: f64) -> usize {
    let mut at = peak;
    while ((at - peak) as f64) < 2.0 * cycle {
        let sign = (x[at] - mean).signum();
        let Some(length) = x[at..].iter().position(|x| (x - mean) * sign <= 0.0) else { break };
        if QUARTER.contains(&(length as f64 / cycle)) {
            return at;
        }
        let next = &x[at + length..];
        let lobe = next.iter().position(|x| (x - mean) * sign > 0.0).unwrap_or(next.len());
        let top = (0..lobe).max_by(|&i, &j| (next[i] - mean).abs().total_cmp(&(next[j] - mean).abs()));
        at += length + top.unwrap_or(0);
    }
    peak
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Acceleration of a linear mode, 100 samples a cycle, under a half sine a fifth of a cycle long.
    fn struck() -> Vec<f64> {
        let (omega, dt) = (std::f64::consts::TAU, 0.01);
        let mut motion = [0.0_f64, 0.0];
        let force = |t: f64| if t < 0.2 { 100.0 * (std::f64::consts::PI * t / 0.2).sin() } else { 0.0 };
        let step = |n: i32| {
            let acceleration = force(f64::from(n) * dt) - omega * omega * motion[0];
            motion[1] += dt * acceleration;
            motion[0] += dt * motion[1];
            acceleration
        };
        (0..500).map(step).collect()
    }

    #[test]
    fn a_blow_is_no_free_decay() {
        let x = struck();
        let largest = first_of_the_largest(x.iter().map(|x| x.abs()));
        assert!(largest < 20, "{largest}");
        let first = behind_the_blow(&x, 0.0, largest, 100.0);
        assert!((30..60).contains(&first) && x[first] < 0.0, "{first}");
    }

    #[test]
    fn a_release_is_its_own_first_peak() {
        let x: Vec<f64> = (0..500).map(|n| (0.02 * std::f64::consts::PI * f64::from(n)).cos()).collect();
        assert_eq!(behind_the_blow(&x, 0.0, 0, 100.0), 0);
        // Peaks that are equal but for where samples meet them: the first.
        let x: Vec<f64> = (0..500).map(|n| (0.31 * f64::from(n)).cos().abs()).collect();
        assert_eq!(first_of_the_largest(x.iter().copied()), 0);
    }
}
