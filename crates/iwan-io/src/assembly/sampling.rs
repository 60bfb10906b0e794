//! From a vector of times to a uniform grid: tolerance of rounding, refusal, or interpolation.

/// Largest relative deviation of an interval from the mean interval that counts as uniform. Samples of a sinusoid with ten samples a cycle
/// are then off by 2π/10 · 1e-3 of its amplitude at most, 64 dB below it: below the noise of a test. Where an interval deviates by more,
/// the times are examined for rounding, and refused or resampled where rounding does not explain them.
pub(crate) const UNIFORM: f64 = 1e-3;

/// Times that lie within this part of an interval of an even grid count as even, with a warning: samples of a sinusoid with ten samples a
/// cycle are then off by 2π/10 · 5e-3 of its amplitude at most, 50 dB below it. Published records whose times were rounded and shifted
/// afterwards lie within it.
pub(crate) const JITTER: f64 = 5e-3;

/// Coarsest rounding of written times that is tolerated, as a part of an interval: a missing sample moves the grid by one interval, two
/// units of this rounding, which half a unit on either side cannot hide. Coarser times are not taken as rounded.
const ROUNDING: f64 = 0.5;

/// Numbers of decimals that are tried as the rounding of times, from whole seconds to nanoseconds. Times with more digits have those of
/// single or double precision, which is tried as well.
const DECIMALS: std::ops::RangeInclusive<i32> = 0..=9;

/// Largest distance of a time from a multiple of a quantum (a unit of rounding), as a part of the quantum, at which the time counts as that
/// multiple. In double precision a time of an hour, counted in nanoseconds, is off by 5e-4 of one. A time that is not rounded passes once
/// in five hundred, and all times have to pass.
const MULTIPLE: f64 = 1e-3;

/// Steps of the search for the interval of a grid. Each step takes a third off the bracket around the interval, so that 1e-14 of the
/// bracket is left.
const STEPS: usize = 80;

/// What a vector of times was found to be.
#[derive(Debug, PartialEq)]
pub(crate) enum Times {
    /// Uniform within [`UNIFORM`].
    Uniform { dt: f64 },
    /// Uniform within half a unit of the last digit written; `quantum`, s, is the largest such unit.
    Rounded { dt: f64, quantum: f64 },
    /// Within [`JITTER`] of a uniform grid; `jitter` is the largest distance from it, s.
    Near { dt: f64, jitter: f64 },
    /// The time of this sample is smaller than the time before it.
    Unordered { sample: usize },
    /// Never decreasing, but the time of this sample equals the time before it; so do the times of `count` samples in all.
    Repeated { sample: usize, count: usize },
    /// Increasing, but uneven: the interval that differs most from the mean ends at this sample, and the times lie up to `off` intervals
    /// off an even grid.
    Uneven { dt: f64, sample: usize, off: f64 },
}

/// Judges times, of which there are at least two, all finite.
pub(crate) fn judge(times: &[f64]) -> Times {
    if let Some(i) = times.windows(2).position(|w| w[1] < w[0]) {
        return Times::Unordered { sample: i + 1 };
    }
    let dt = mean_interval(times);
    if dt == 0.0 {
        return Times::Repeated { sample: 1, count: times.len() - 1 };
    }
    let Worst { sample, deviation } = worst_interval(times, dt);
    if deviation <= UNIFORM {
        return Times::Uniform { dt };
    }
    if let Some(fitted) = rounded(times, dt) {
        return fitted;
    }
    if let Some(first) = times.windows(2).position(|w| w[1] == w[0]) {
        let count = times.windows(2).filter(|w| w[1] == w[0]).count();
        return Times::Repeated { sample: first + 1, count };
    }
    let even = grid(times, &vec![0.0; times.len()]);
    if even.jitter <= JITTER * even.dt {
        return Times::Near { dt: even.dt, jitter: even.jitter };
    }
    Times::Uneven { dt, sample, off: even.jitter / even.dt }
}

fn mean_interval(times: &[f64]) -> f64 {
    (times[times.len() - 1] - times[0]) / (times.len() - 1) as f64
}

/// Whether the values could be times: at least three, increasing, uniform.
pub(crate) fn is_clock(values: &[f64]) -> bool {
    values.len() >= 3
        && values.iter().all(|v| v.is_finite())
        && matches!(judge(values), Times::Uniform { .. } | Times::Rounded { .. } | Times::Near { .. })
}

/// The interval that differs most from the mean interval.
struct Worst {
    /// The sample at its end.
    sample: usize,
    /// Relative difference of the interval from the mean interval.
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

/// The even grid on which the times lie when each is moved by at most half a unit of its last digit; none where there is no such grid, or
/// where the unit is too coarse to tell.
fn rounded(times: &[f64], dt: f64) -> Option<Times> {
    let units = units_of_last_digit(times);
    let largest = units.iter().copied().fold(0.0, f64::max);
    if largest == 0.0 || largest > ROUNDING * dt {
        return None;
    }
    // A little more than half, for the rounding of the arithmetic.
    let half: Vec<f64> = times
        .iter()
        .zip(&units)
        .map(|(t, q)| 0.5 * (1.0 + 1e-6) * q + 4.0 * f64::EPSILON * t.abs())
        .collect();
    let even = grid(times, &half);
    (even.jitter <= 0.0).then_some(Times::Rounded { dt: even.dt, quantum: largest })
}

/// An even grid.
struct Even {
    dt: f64,
    /// Largest distance of a time from the grid beyond the distance allowed for that time, s; negative where all times lie nearer than
    /// allowed.
    jitter: f64,
}

/// The even grid for which the largest distance of a time beyond `allowed` (s, one for each time) is least. For an interval b, that
/// distance is half of max(t - b i - allowed) - min(t - b i + allowed). It is convex in b, so that a bracket that loses a third at a time
/// finds the least.
fn grid(times: &[f64], allowed: &[f64]) -> Even {
    let beyond = |dt: f64| {
        let ends = times.iter().zip(allowed).enumerate();
        let (low, high) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), (i, (t, a))| {
            let left = t - times[0] - dt * i as f64;
            (low.min(left + a), high.max(left - a))
        });
        0.5 * (high - low)
    };
    let (n, mean) = (times.len(), mean_interval(times));
    let reach = (beyond(mean).max(0.0) * 2.0 + allowed[0] + allowed[n - 1]) / (n - 1) as f64;
    let (mut low, mut high) = (mean - reach, mean + reach);
    for _ in 0..STEPS {
        let third = (high - low) / 3.0;
        let (a, b) = (low + third, high - third);
        if beyond(a) < beyond(b) { high = b } else { low = a }
    }
    let dt = 0.5 * (low + high);
    Even { dt, jitter: beyond(dt) }
}

/// The largest unit of the last digit with which the times were written, s.
pub(crate) fn last_digit(times: &[f64]) -> f64 {
    units_of_last_digit(times).into_iter().fold(0.0, f64::max)
}

/// For each time, the unit of the last digit with which it was written, s. For all times of one power of ten it is the coarsest unit of
/// which all of them are multiples. Where there is no such unit, it is that of single precision, if all times are single-precision numbers,
/// or else of double precision.
fn units_of_last_digit(times: &[f64]) -> Vec<f64> {
    let sizes: Vec<i32> = times.iter().map(|t| decade(*t)).collect();
    let mut digits = std::collections::BTreeMap::new();
    for (t, size) in times.iter().zip(&sizes) {
        let found: &mut i32 = digits.entry(*size).or_insert(*DECIMALS.start());
        while *found <= *DECIMALS.end() && !is_multiple(*t, 10.0_f64.powi(-*found)) {
            *found += 1;
        }
    }
    let unit = |digits: i32| if DECIMALS.contains(&digits) { 10.0_f64.powi(-digits) } else { 0.0 };
    let mut units: Vec<(i32, f64)> = digits.into_iter().map(|(size, digits)| (size, unit(digits))).collect();
    // A few times may be round by chance. So a smaller time has no coarser unit than a larger one, and a larger time has at most one digit
    // less for each power of ten.
    for i in (1..units.len()).rev() {
        units[i - 1].1 = units[i - 1].1.min(units[i].1);
    }
    for i in 1..units.len() {
        let steps = units[i].0 - units[i - 1].0;
        units[i].1 = units[i].1.min(units[i - 1].1 * 10.0_f64.powi(steps));
    }
    let single = times.iter().all(|&t| f64::from(narrow(t)) == t);
    let precision = if single { f64::from(f32::EPSILON) } else { f64::EPSILON };
    let of = |(t, size): (&f64, &i32)| {
        let at = units.partition_point(|(of, _)| of < size);
        units[at].1.max(t.abs() * precision)
    };
    times.iter().zip(&sizes).map(of).collect()
}

/// Power of ten of a number's size, at least that of the smallest unit examined; 0 has this least power.
fn decade(t: f64) -> i32 {
    let least = -*DECIMALS.end();
    if t == 0.0 { least } else { (t.abs().log10().floor() as i32).max(least) }
}

#[allow(clippy::cast_possible_truncation)] // rounding to single precision is what is asked
fn narrow(t: f64) -> f32 {
    t as f32
}

fn is_multiple(t: f64, q: f64) -> bool {
    let steps = t / q;
    // A number far smaller than the quantum is no multiple of it.
    (steps - steps.round()).abs() < MULTIPLE && (t == 0.0 || steps.round() != 0.0)
}

/// What interpolation onto as many even times, from the first to the last time, did; the times never decrease.
pub(crate) struct Resampled {
    pub(crate) dt: f64,
    /// Largest distance of a stored time from an even grid, s.
    pub(crate) jitter: f64,
    /// Longest time without a sample, s.
    pub(crate) gap: f64,
    /// Number of times that equal the time before.
    pub(crate) merged: usize,
}

/// Interpolates channels, sampled at `times` (s, never decreasing, not all equal), onto an even grid. Samples with equal times are
/// averaged. Where no times are equal, cubics go through the samples; a clock that repeats times is too coarse for slopes, and straight
/// lines are used.
pub(crate) fn on_even_grid(times: &[f64], channels: &mut [&mut Vec<f64>]) -> Resampled {
    let n = times.len();
    let dt = mean_interval(times);
    let mut firsts: Vec<usize> = (0..n).filter(|&i| i == 0 || times[i] > times[i - 1]).collect();
    let stamps: Vec<f64> = firsts.iter().map(|&i| times[i]).collect();
    firsts.push(n);
    let merged = n - stamps.len();
    for channel in channels {
        let mean = |w: &[usize]| channel[w[0]..w[1]].iter().sum::<f64>() / (w[1] - w[0]) as f64;
        let values: Vec<f64> = firsts.windows(2).map(mean).collect();
        **channel = resample(&stamps, &values, n, dt, if merged == 0 { hermite } else { line });
    }
    let jitter = grid(times, &vec![0.0; n]).jitter;
    let gap = stamps.windows(2).map(|w| w[1] - w[0]).fold(0.0, f64::max);
    Resampled { dt, jitter, gap, merged }
}

/// `n` samples at `start + i dt`, interpolated by `between` in the interval that begins at a sample.
///
/// For cubic Hermite interpolation the slope at each sample is that of the parabola through it and its neighbours (three-point formula
/// for uneven spacing), so that cubic accuracy is lost only at the two ends and a parabola is reproduced exactly.
fn resample(
    times: &[f64],
    values: &[f64],
    n: usize,
    dt: f64,
    between: fn(&[f64], &[f64], usize, f64) -> f64,
) -> Vec<f64> {
    let mut interval = 0;
    let last = times.len() - 2;
    (0..n)
        .map(|i| {
            let t = (times[0] + i as f64 * dt).min(times[last + 1]);
            while interval < last && times[interval + 1] < t {
                interval += 1;
            }
            between(times, values, interval, t)
        })
        .collect()
}

fn line(times: &[f64], values: &[f64], i: usize, t: f64) -> f64 {
    let x = (t - times[i]) / (times[i + 1] - times[i]);
    values[i] + x * (values[i + 1] - values[i])
}

fn hermite(times: &[f64], values: &[f64], i: usize, t: f64) -> f64 {
    let h = times[i + 1] - times[i];
    let x = (t - times[i]) / h;
    let (a, b) = (slope(times, values, i) * h, slope(times, values, i + 1) * h);
    let rise = values[i + 1] - values[i];
    values[i] + x * (a + x * (3.0 * rise - 2.0 * a - b + x * (a + b - 2.0 * rise)))
}

/// Slope at sample `i` of the parabola through three neighbouring samples; of the straight line where there are only two samples.
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
        assert_eq!(judge(&[0.0, 1.0, 1.0]), Times::Repeated { sample: 2, count: 1 });
        assert_eq!(judge(&[0.0, 2.0, 1.0, 3.0]), Times::Unordered { sample: 2 });
    }

    #[test]
    fn rounded_decimals_and_single_precision_are_tolerated() {
        let rounded: Vec<f64> = (0..1000).map(|i| (f64::from(i) / 12800.0 * 1e6).round() / 1e6).collect();
        let Times::Rounded { quantum, .. } = judge(&rounded) else { panic!("{:?}", judge(&rounded)) };
        assert!((quantum / 1e-6 - 1.0).abs() < 1e-12, "{quantum:e}");
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
        for (i, v) in resample(&times, &values, 40, dt, hermite).iter().enumerate() {
            let t = times[0] + i as f64 * dt;
            assert!((v - (2.0 - t + 0.5 * t * t)).abs() < 1e-9);
        }
    }

    /// Times with six significant digits (microseconds below one second, tens of microseconds above), and 400 Hz in whole milliseconds.
    #[test]
    fn half_a_unit_of_the_last_digit_is_allowed_whatever_the_digit() {
        let six = |t: f64| -> f64 { format!("{t:.5e}").parse().unwrap() };
        let t: Vec<f64> = (0..20_000).map(|i| six(f64::from(i) / 5120.0)).collect();
        let Times::Rounded { dt, quantum } = judge(&t) else { panic!("{:?}", judge(&t)) };
        assert!((dt * 5120.0 - 1.0).abs() < 1e-6 && (quantum - 1e-5).abs() < 1e-15, "{dt} {quantum}");
        let t: Vec<f64> = (0..1000).map(|i| (f64::from(i) * 2.5).round() / 1e3).collect();
        assert!(matches!(judge(&t), Times::Rounded { dt, .. } if (dt * 400.0 - 1.0).abs() < 1e-5));
        for lost in [3, 500, 996] {
            let mut t = t.clone();
            t.remove(lost);
            assert!(matches!(judge(&t), Times::Uneven { .. }), "{lost}: {:?}", judge(&t));
        }
    }

    #[test]
    fn rounded_times_that_were_shifted_afterwards_are_near_enough() {
        let t: Vec<f64> = (0..9000).map(|i| (0.9 + f64::from(i) / 5120.0) * 1e6).map(f64::round).collect();
        let t: Vec<f64> = t.iter().map(|t| t / 1e6 - 0.900_000_3).collect();
        let Times::Near { dt, jitter } = judge(&t) else { panic!("{:?}", judge(&t)) };
        assert!((dt * 5120.0 - 1.0).abs() < 1e-6 && jitter < 0.6e-6, "{dt} {jitter}");
    }

    #[test]
    fn a_clock_that_stutters_is_told_from_one_that_runs_back() {
        let t: Vec<f64> = (0..500).map(|i| (0.6 * f64::from(i)).floor() * 1e-3).collect();
        assert_eq!(judge(&t), Times::Repeated { sample: 1, count: 200 });
        let mut x: Vec<f64> = t.iter().map(|t| 3.0 * t).collect();
        let done = on_even_grid(&t, &mut [&mut x]);
        assert_eq!((x.len(), done.merged), (500, 200));
        assert!(done.jitter < 1e-3 && (done.gap - 1e-3).abs() < 1e-12);
        for (i, v) in x.iter().enumerate() {
            assert!((v - 3.0 * done.dt * i as f64).abs() < 1e-9);
        }
    }
}
