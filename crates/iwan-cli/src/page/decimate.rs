//! Long histories as short lines that look the same.

/// Stretches of a history, of each of which the smallest and the largest value are drawn. The plane of a figure is 494 units
/// wide, nearly pixels: more stretches are not seen and make the page larger, fewer than 500 make a ring-down ragged.
pub(crate) const STRETCHES: usize = 700;

/// Points of `samples` at `dt`: the smallest and the largest of each of `bins` stretches, in their order, and both ends of
/// the history. A history of up to twice as many samples stays as it is.
pub(crate) fn history(samples: &[f64], dt: f64, bins: usize) -> Vec<(f64, f64)> {
    let point = |n: usize| (n as f64 * dt, samples[n]);
    if samples.len() <= 2 * bins {
        return (0..samples.len()).map(point).collect();
    }
    let mut kept = vec![0];
    for bin in 0..bins {
        let range = bin * samples.len() / bins..(bin + 1) * samples.len() / bins;
        let by_value = |a: &usize, b: &usize| samples[*a].total_cmp(&samples[*b]);
        let (low, high) = (range.clone().min_by(by_value), range.max_by(by_value));
        kept.extend(low);
        kept.extend(high);
    }
    kept.push(samples.len() - 1);
    kept.sort_unstable();
    kept.dedup();
    kept.into_iter().map(point).collect()
}

/// The highest point of each of `bins` stretches of equal ratio in x; points with x <= 0 have no place.
pub(crate) fn crests(points: &[(f64, f64)], bins: usize) -> Vec<(f64, f64)> {
    let (Some(first), Some(last)) = (points.iter().find(|p| p.0 > 0.0), points.last()) else {
        return Vec::new();
    };
    let scale = bins as f64 / (last.0 / first.0).ln().max(f64::MIN_POSITIVE);
    let bin = |x: f64| ((x / first.0).ln() * scale) as usize;
    let mut kept: Vec<(f64, f64)> = Vec::new();
    for point in points.iter().filter(|p| p.0 > 0.0) {
        match kept.last_mut() {
            Some(highest) if bin(highest.0) == bin(point.0) => {
                if point.1 > highest.1 {
                    *highest = *point;
                }
            }
            _ => kept.push(*point),
        }
    }
    kept
}

/// About `most` of the points, evenly picked, both ends among them.
pub(crate) fn thin<T: Copy>(points: &[T], most: usize) -> Vec<T> {
    let stride = points.len().div_ceil(most.max(1)).max(1);
    let mut kept: Vec<T> = points.iter().copied().step_by(stride).collect();
    if let (Some(last), false) = (points.last(), (points.len().max(1) - 1).is_multiple_of(stride)) {
        kept.push(*last);
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn peaks_survive_and_time_ascends() {
        let samples: Vec<f64> =
            (0..100_000).map(|n| (f64::from(n) * 0.37).sin()).chain([7.0, -0.5]).collect();
        let points = history(&samples, 1e-3, 300);
        assert!(points.len() <= 602 && points.is_sorted_by(|a, b| a.0 < b.0));
        assert!(points.iter().any(|p| p.1 == 7.0) && points.last().is_some_and(|p| p.1 == -0.5));
        assert_eq!(history(&[1.0, 2.0], 0.5, 300), [(0.0, 1.0), (0.5, 2.0)]);
    }

    #[test]
    fn crests_survive() {
        let points: Vec<(f64, f64)> =
            (0..10_000).map(|n| (f64::from(n), if n == 4321 { 9.0 } else { 1.0 })).collect();
        let kept = crests(&points, 200);
        assert!(kept.len() <= 201 && kept.contains(&(4321.0, 9.0)) && kept.is_sorted_by(|a, b| a.0 < b.0));
        assert_eq!(crests(&[(0.0, 1.0)], 10), []);
    }

    #[test]
    fn thinning_keeps_both_ends() {
        let points: Vec<u32> = (0..1001).collect();
        let few = thin(&points, 10);
        assert!(few.len() <= 12 && few[0] == 0 && few.last() == Some(&1000));
        assert_eq!(thin(&[1, 2, 3], 10), [1, 2, 3]);
        assert_eq!(thin::<u32>(&[], 10), [0u32; 0]);
    }
}
