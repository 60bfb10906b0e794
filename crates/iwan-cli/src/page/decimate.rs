//! Long histories shortened to polylines that look the same.

/// Number of stretches into which a history is cut; the smallest and the largest value of each are drawn. The plane of a figure is 494 units (nearly
/// pixels) wide: more stretches are not visible and make the page larger, fewer than 500 make a ring-down look ragged.
pub(crate) const STRETCHES: usize = 700;

/// The points (time, value) to draw of `samples` at the interval `dt`: the smallest and the largest sample of each of `bins` stretches, in their
/// order, and both ends. A history of at most twice as many samples is returned whole.
pub(crate) fn history(samples: &[f64], dt: f64, bins: usize) -> Vec<(f64, f64)> {
    let mut passing = Passing::new(samples.len(), bins);
    passing.add(samples);
    passing.points(dt)
}

/// A history whose samples arrive piece by piece; only the points to be drawn are kept.
#[derive(Debug, Clone)]
pub(crate) struct Passing {
    /// Number of all samples, and below it of those that have arrived.
    length: usize,
    passed: usize,
    bins: usize,
    /// Number and value of each kept sample, in their order.
    kept: Vec<(usize, f64)>,
    /// The smallest and the largest sample of the current stretch.
    extremes: Option<[(usize, f64); 2]>,
    /// End of the current stretch, as a sample number.
    until: usize,
}

impl Passing {
    /// Begins a history of `length` samples, to be drawn in `bins` stretches.
    pub(crate) fn new(length: usize, bins: usize) -> Self {
        Self { length, passed: 0, bins, kept: Vec::new(), extremes: None, until: 0 }
    }

    /// Adds the next samples.
    pub(crate) fn add(&mut self, samples: &[f64]) {
        for &value in samples {
            let this = (self.passed, value);
            if self.length <= 2 * self.bins {
                self.kept.push(this);
            } else {
                self.follow(this);
            }
            self.passed += 1;
        }
    }

    fn follow(&mut self, this: (usize, f64)) {
        if this.0 >= self.until {
            self.close();
            // The stretch that contains this sample.
            let bin = ((this.0 + 1) * self.bins - 1) / self.length;
            self.until = (bin + 1) * self.length / self.bins;
        }
        let [low, high] = self.extremes.get_or_insert([this, this]);
        if this.1 < low.1 {
            *low = this;
        }
        if this.1 >= high.1 {
            *high = this;
        }
        if this.0 == 0 || this.0 + 1 == self.length {
            self.kept.push(this);
        }
    }

    fn close(&mut self) {
        self.kept.extend(self.extremes.take().into_iter().flatten());
    }

    /// The points to draw, as time and value.
    pub(crate) fn points(mut self, dt: f64) -> Vec<(f64, f64)> {
        self.close();
        self.kept.sort_unstable_by_key(|point| point.0);
        self.kept.dedup_by_key(|point| point.0);
        self.kept.into_iter().map(|(n, value)| (n as f64 * dt, value)).collect()
    }
}

/// The highest point of each of `bins` stretches of equal ratio in x; points with x <= 0 are left out.
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
    fn a_history_in_pieces_is_the_history_at_once() {
        let samples: Vec<f64> = (0..50_003).map(|n| (f64::from(n) * 0.11).sin()).collect();
        let mut passing = Passing::new(samples.len(), 300);
        for piece in samples.chunks(777) {
            passing.add(piece);
        }
        let points = passing.points(1e-3);
        assert_eq!(points, history(&samples, 1e-3, 300));
        // The smallest and the largest value of each stretch, found again from the samples.
        for bin in 0..300 {
            let range = bin * samples.len() / 300..(bin + 1) * samples.len() / 300;
            let most = samples[range].iter().copied().fold(f64::NEG_INFINITY, f64::max);
            assert!(points.iter().any(|p| p.1 == most), "{bin}");
        }
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
