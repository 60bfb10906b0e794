//! Amplitudes, evenly apart in their logarithm, and curves through values at them.

use nalgebra::{DMatrix, Vector4};

/// Largest distance of neighbouring amplitudes in ln a, unless there are too many of them: cubics through the values of any power of the amplitude up
/// to the third are then good to 1e-4.
const STEP: f64 = 0.15;
/// Fewest amplitudes: a cubic takes four values, and more are needed to see it bend.
const FEWEST: usize = 8;
/// Most amplitudes: two decades at `STEP`. More cost time and tell no more; a wider range has wider steps.
const MOST: usize = 32;
/// Part of a step within which an amplitude of the grid is not told beside an end of a range: two values so near make no slope.
const BESIDE: f64 = 0.1;

/// Amplitudes, equal steps of ln a apart, at which curves have their values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Grid {
    low: f64,
    step: f64,
    count: usize,
}

/// The place of a value of ln a between the amplitudes: the first of four neighbours, and their cubic weights.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place {
    first: usize,
    weights: [f64; 4],
}

impl Place {
    /// A curve there.
    pub(crate) fn of(&self, values: &[f64]) -> f64 {
        self.weights.iter().zip(&values[self.first..]).map(|(weight, value)| weight * value).sum()
    }

    /// Its variance, where the covariance of the curve's values begins at the row and column `from`.
    pub(crate) fn variance(&self, covariance: &DMatrix<f64>, from: usize) -> f64 {
        let block = covariance.fixed_view::<4, 4>(from + self.first, from + self.first);
        let weights = Vector4::from(self.weights);
        weights.dot(&(block * weights)).max(0.0)
    }
}

impl Grid {
    /// The grid from one amplitude to another.
    pub(crate) fn over(low: f64, high: f64) -> Self {
        let range = (high / low).ln().max(1e-3);
        let count = ((range / STEP).ceil() as usize + 1).clamp(FEWEST, MOST);
        Self { low: low.ln(), step: range / (count - 1) as f64, count }
    }

    pub(crate) const fn count(&self) -> usize {
        self.count
    }

    /// Logarithm of an amplitude.
    pub(crate) fn log(&self, i: usize) -> f64 {
        self.low + self.step * i as f64
    }

    pub(crate) fn amplitude(&self, i: usize) -> f64 {
        self.log(i).exp()
    }

    pub(crate) fn amplitudes(&self) -> Vec<f64> {
        (0..self.count).map(|i| self.amplitude(i)).collect()
    }

    /// Geometric mean of all amplitudes.
    pub(crate) fn middle(&self) -> f64 {
        (self.low + 0.5 * self.step * (self.count - 1) as f64).exp()
    }

    /// The cubic through the four nearest values (Lagrange's); beyond the ends the last value is held.
    pub(crate) fn place(&self, log: f64) -> Place {
        let x = ((log - self.low) / self.step).clamp(0.0, (self.count - 1) as f64);
        let first = (x as usize).saturating_sub(1).min(self.count - 4);
        let s = x - first as f64;
        let (a, b, c, d) = (s, s - 1.0, s - 2.0, s - 3.0);
        Place { first, weights: [-b * c * d / 6.0, a * c * d / 2.0, -a * b * d / 2.0, a * b * c / 6.0] }
    }

    /// The values of two curves at a value of ln a.
    pub(crate) fn at(&self, log: f64, one: &[f64], other: &[f64]) -> (f64, f64) {
        let place = self.place(log);
        (place.of(one), place.of(other))
    }

    /// Logarithms at which curves are told that are known from one to another: both ends, as far as the grid reaches, and the grid's own in
    /// between; only that in the middle where the ends are less than a step apart, which tells no slope.
    pub(crate) fn within(&self, (low, high): (f64, f64)) -> Vec<f64> {
        let (low, high) = (low.max(self.log(0)), high.min(self.log(self.count - 1)));
        if high - low < self.step {
            return vec![0.5 * (low + high)];
        }
        let beside = BESIDE * self.step;
        let between =
            (0..self.count).map(|i| self.log(i)).filter(|log| (low + beside..high - beside).contains(log));
        std::iter::once(low).chain(between).chain([high]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_of_the_amplitude_between_its_values() {
        let grid = Grid::over(0.01, 1.0);
        assert!((grid.amplitude(0) - 0.01).abs() < 1e-15 && (grid.amplitude(31) - 1.0).abs() < 1e-14);
        let powers = |p: f64| -> Vec<f64> { grid.amplitudes().iter().map(|a| a.powf(p)).collect() };
        let (square, inverse) = (powers(2.0), powers(-1.0));
        for a in [0.0107, 0.1, 0.33, 0.99] {
            let (s, i) = grid.at(f64::ln(a), &square, &inverse);
            assert!((s / (a * a) - 1.0).abs() < 1e-3 && (i * a - 1.0).abs() < 1e-4, "{a} {s} {i}");
        }
        assert_eq!(grid.at(3.0, &square, &inverse).0, square[31]);
    }

    #[test]
    fn curves_are_told_from_end_to_end_of_what_was_seen() {
        let grid = Grid::over(0.01, 1.0);
        let (low, high) = (f64::ln(0.0512), f64::ln(0.731));
        let told = grid.within((low, high));
        assert_eq!((told[0], told[told.len() - 1]), (low, high));
        assert!(told.windows(2).all(|pair| pair[1] - pair[0] > 0.09 * grid.step), "{told:?}");
        // No farther than the grid, and one amplitude where there is only one.
        assert_eq!(grid.within((-9.0, 9.0)).len(), 32);
        assert_eq!(grid.within((low, low + 0.9 * grid.step)).len(), 1);
    }

    #[test]
    fn variances_between_amplitudes_are_those_of_the_cubic() {
        let grid = Grid::over(0.01, 1.0);
        // Values that are all off by the same: so is every cubic through them, at any place.
        let same = DMatrix::from_element(64, 64, 4.0);
        let place = grid.place(f64::ln(0.0731));
        assert!((place.variance(&same, 32) - 4.0).abs() < 1e-12);
        // Independent ones: the sum of squared weights, 1 at an amplitude of the grid.
        let own = DMatrix::identity(64, 64);
        assert!((grid.place(grid.log(7)).variance(&own, 0) - 1.0).abs() < 1e-9);
        assert!(place.variance(&own, 0) < 1.0);
    }
}
