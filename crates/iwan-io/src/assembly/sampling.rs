//! From a vector of times to a uniform grid: tolerance of rounding, refusal, or interpolation.

/// Largest relative deviation of an interval from the mean one that counts as uniform. Samples of a sinusoid with ten of
/// them a cycle are then off by 2π/10 · 1e-3 of its amplitude at most, 64 dB below it: below the noise of a test. Beyond it
/// the times are looked at for rounding, and refused or resampled where that does not explain them.
pub(crate) const UNIFORM: f64 = 1e-3;

/// Rounding of the written times is tolerated up to this part of an interval: above it, rounding and a clock that
/// really is uneven cannot be told apart.
const ROUNDING: f64 = 0.1;

/// Two rounded times differ from the true interval by at most one quantum; a tenth more for the error of the mean
/// interval, which is that of the two ends over the number of intervals.
const QUANTA: f64 = 1.1;

/// Decimals to which times are looked at for rounding, from whole seconds to nanoseconds: more digits than this are those
/// of single or double precision, which are tried as well.
const DECIMALS: std::ops::RangeInclusive<i32> = 0..=9;

/// A time is a multiple of a quantum when it is one within this part of the quantum. In double precision a time of an hour,
/// counted in nanoseconds, is off by 5e-4 of one; a time that is not rounded passes once in five hundred, and all of them
/// have to.
const MULTIPLE: f64 = 1e-3;

/// What a vector of times is.
#[derive(Debug, PartialEq)]
pub(crate) enum Times {
    /// Uniform within [`UNIFORM`].
    Uniform { dt: f64 },
    /// Uniform within the rounding of the written numbers.
    Rounded { dt: f64, quantum: f64 },
    /// Not increasing at this sample.
    Unordered { sample: usize },
    /// Increasing, but uneven; the worst interval ends at this sample.
    Uneven { dt: f64, sample: usize, deviation: f64 },
}

/// Judges at least two finite times.
pub(crate) fn judge(times: &[f64]) -> Times {
    if let Some(i) = times.windows(2).position(|w| w[1] <= w[0]) {
        return Times::Unordered { sample: i + 1 };
    }
    let dt = (times[times.len() - 1] - times[0]) / (times.len() - 1) as f64;
    let Worst { sample, deviation } = worst_interval(times, dt);
    if deviation <= UNIFORM {
        return Times::Uniform { dt };
    }
    let quantum = quantum(times);
    if quantum <= ROUNDING * dt && deviation * dt <= QUANTA * quantum {
        return Times::Rounded { dt, quantum };
    }
    Times::Uneven { dt, sample, deviation }
}

/// Whether the values could be times: at least three, increasing, uniform.
pub(crate) fn is_clock(values: &[f64]) -> bool {
    values.len() >= 3
        && values.iter().all(|v| v.is_finite())
        && matches!(judge(values), Times::Uniform { .. } | Times::Rounded { .. })
}

/// The interval that differs most from the mean one.
struct Worst {
    /// The sample at its end.
    sample: usize,
    /// Difference over the mean interval.
    deviation: f64,
}

fn worst_interval(times: &[f64], dt: f64) -> Worst {
    let mut worst = Worst { sample: 1, deviation: 0.0 };
    for (i, w) in times.windows(2).enumerate() {
        let deviation = ((w[1] - w[0]) / dt - 1.0).abs();
        if deviation > worst.deviation {
            worst = Worst { sample: i + 1, deviation };
        }
    }
    worst
}

/// Step to which the times are rounded: a power of ten, single precision, or double precision.
fn quantum(times: &[f64]) -> f64 {
    let largest = times.iter().fold(0.0_f64, |m, t| m.max(t.abs()));
    let decimal = DECIMALS.map(|k| 10.0_f64.powi(-k)).find(|q| times.iter().all(|t| is_multiple(*t, *q)));
    let single = times.iter().all(|&t| f64::from(narrow(t)) == t);
    let double = largest * f64::EPSILON;
    let single = if single { largest * f64::from(f32::EPSILON) } else { 0.0 };
    decimal.unwrap_or(0.0).max(single).max(double)
}

#[allow(clippy::cast_possible_truncation)] // rounding to single precision is what is asked
fn narrow(t: f64) -> f32 {
    t as f32
}

fn is_multiple(t: f64, q: f64) -> bool {
    let steps = t / q;
    (steps - steps.round()).abs() < MULTIPLE
}

/// Samples at `start + i dt`, as many as there are times, by cubic Hermite interpolation.
///
/// The slope at each sample is that of the parabola through it and its neighbours (three-point formula for uneven
/// spacing), so that cubic accuracy is lost only at the two ends and a parabola is reproduced exactly.
pub(crate) fn resample(times: &[f64], values: &[f64], dt: f64) -> Vec<f64> {
    let mut interval = 0;
    let last = times.len() - 2;
    (0..times.len())
        .map(|i| {
            let t = (times[0] + i as f64 * dt).min(times[last + 1]);
            while interval < last && times[interval + 1] < t {
                interval += 1;
            }
            hermite(times, values, interval, t)
        })
        .collect()
}

fn hermite(times: &[f64], values: &[f64], i: usize, t: f64) -> f64 {
    let h = times[i + 1] - times[i];
    let x = (t - times[i]) / h;
    let (a, b) = (slope(times, values, i) * h, slope(times, values, i + 1) * h);
    let rise = values[i + 1] - values[i];
    values[i] + x * (a + x * (3.0 * rise - 2.0 * a - b + x * (a + b - 2.0 * rise)))
}

/// Slope at sample `i` of the parabola through three neighbouring samples; of the line where there are only two.
fn slope(times: &[f64], values: &[f64], i: usize) -> f64 {
    let n = times.len();
    if n < 3 {
        return (values[1] - values[0]) / (times[1] - times[0]);
    }
    let m = i.clamp(1, n - 2);
    let (h0, h1) = (times[m] - times[m - 1], times[m + 1] - times[m]);
    let (d0, d1) = ((values[m] - values[m - 1]) / h0, (values[m + 1] - values[m]) / h1);
    let curvature = (d1 - d0) / (h0 + h1);
    d0 + curvature * (2.0 * times[i] - times[m] - times[m - 1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_grids_are_uniform_and_swapped_times_are_not() {
        let t: Vec<f64> = (0..50).map(|i| -0.01 + f64::from(i) / 12800.0).collect();
        assert!(matches!(judge(&t), Times::Uniform { .. }));
        assert_eq!(judge(&[0.0, 1.0, 1.0]), Times::Unordered { sample: 2 });
        assert_eq!(judge(&[0.0, 2.0, 1.0, 3.0]), Times::Unordered { sample: 2 });
    }

    #[test]
    fn rounded_decimals_and_single_precision_are_tolerated() {
        let rounded: Vec<f64> = (0..1000).map(|i| (f64::from(i) / 12800.0 * 1e6).round() / 1e6).collect();
        assert!(matches!(judge(&rounded), Times::Rounded { quantum, .. } if quantum == 1e-6));
        let single: Vec<f64> = (0..60_000_u16).map(|i| f64::from(f32::from(i) / 12800.0)).collect();
        assert!(matches!(judge(&single), Times::Rounded { .. }));
        let epoch: Vec<f64> = (0..1000).map(|i| 1.7e9 + f64::from(i) / 12800.0).collect();
        assert!(matches!(judge(&epoch), Times::Rounded { .. }));
    }

    #[test]
    fn a_missing_sample_is_uneven_even_when_times_are_short_decimals() {
        let mut t: Vec<f64> = (0..100).map(|i| f64::from(i) * 0.001).collect();
        t.remove(40);
        assert!(matches!(judge(&t), Times::Uneven { sample: 40, .. }));
    }

    #[test]
    fn a_parabola_is_resampled_exactly() {
        let times: Vec<f64> = (0..40).map(|i| f64::from(i) + 0.3 * f64::from(i % 3)).collect();
        let values: Vec<f64> = times.iter().map(|t| 2.0 - t + 0.5 * t * t).collect();
        let dt = (times[39] - times[0]) / 39.0;
        for (i, v) in resample(&times, &values, dt).iter().enumerate() {
            let t = times[0] + i as f64 * dt;
            assert!((v - (2.0 - t + 0.5 * t * t)).abs() < 1e-9);
        }
    }
}
