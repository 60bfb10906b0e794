//! Weighted least squares by a cubic spline with uniform knots (C. de Boor, A Practical Guide to Splines, ch. XIV).

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::points::{Points, Smooth, Smoothed, Stretch};

/// Numbers of intervals to choose from, in steps of a half to a third, finer than Schwarz's criterion can tell apart. Sixteen intervals follow what
/// twelve coefficients of a polynomial (the Hilbert method) follow, and more would follow noise.
const INTERVALS: [usize; 8] = [1, 2, 3, 4, 6, 8, 12, 16];

/// A fitted cubic spline.
#[derive(Debug, Clone)]
pub(crate) struct Spline {
    start: f64,
    width: f64,
    intervals: usize,
    coefficients: DVector<f64>,
    /// Factor of the normal matrix, and (`variance`) variance of a value of weight 1.
    factor: Cholesky<f64, Dyn>,
    variance: f64,
}

/// A spline and Schwarz's criterion for it.
struct Scored {
    spline: Spline,
    criterion: f64,
}

impl Spline {
    /// The spline with the number of intervals for which Schwarz's criterion is least, or with as many as `given`. None when there are too few
    /// points.
    pub(crate) fn fit(points: &Points<'_>, given: Option<usize>) -> Option<Self> {
        let candidates = given.map_or(INTERVALS.to_vec(), |m| vec![m]);
        candidates
            .into_iter()
            .filter(|m| 2 * (m + 3) <= points.t.len())
            .filter_map(|m| Self::with_intervals(points, m))
            .min_by(|a, b| a.criterion.total_cmp(&b.criterion))
            .map(|best| best.spline)
    }

    fn with_intervals(points: &Points<'_>, intervals: usize) -> Option<Scored> {
        let Stretch { middle, half } = points.stretch();
        let (start, width) = (middle - half, 2.0 * half / intervals as f64);
        let n = intervals + 3;
        let (mut matrix, mut right) = (DMatrix::zeros(n, n), DVector::zeros(n));
        for ((&t, &y), &w) in points.t.iter().zip(points.y).zip(points.weight) {
            let Basis { first, values, .. } = basis(start, width, intervals, t);
            for i in 0..4 {
                right[first + i] += w * values[i] * y;
                for j in 0..4 {
                    matrix[(first + i, first + j)] += w * values[i] * values[j];
                }
            }
        }
        let factor = Cholesky::new(matrix)?;
        let coefficients = factor.solve(&right);
        let mut spline = Self { start, width, intervals, coefficients, factor, variance: 0.0 };
        let residuals = points.t.iter().zip(points.y).map(|(&t, y)| y - spline.value(t));
        let rss: f64 = residuals.zip(points.weight).map(|(r, w)| w * r * r).sum();
        spline.variance = points.variance(rss, n);
        Some(Scored { spline, criterion: points.criterion(rss, n) })
    }

    fn value(&self, t: f64) -> f64 {
        let Basis { first, values, .. } = basis(self.start, self.width, self.intervals, t);
        (0..4).map(|i| values[i] * self.coefficients[first + i]).sum()
    }

    /// Number of intervals.
    pub(crate) fn intervals(&self) -> usize {
        self.intervals
    }
}

/// The four B-splines that are not zero at a time, with their values and slopes.
struct Basis {
    /// Index of the first of them.
    first: usize,
    values: [f64; 4],
    slopes: [f64; 4],
}

fn basis(start: f64, width: f64, intervals: usize, t: f64) -> Basis {
    let x = ((t - start) / width).clamp(0.0, intervals as f64);
    let first = (x as usize).min(intervals - 1);
    let s = x - first as f64;
    let r = 1.0 - s;
    let values = [
        r * r * r / 6.0,
        2.0 / 3.0 - s * s + 0.5 * s * s * s,
        2.0 / 3.0 - r * r + 0.5 * r * r * r,
        s * s * s / 6.0,
    ];
    let slopes = [-0.5 * r * r, -2.0 * s + 1.5 * s * s, 2.0 * r - 1.5 * r * r, 0.5 * s * s];
    Basis { first, values, slopes: slopes.map(|v| v / width) }
}

impl Smooth for Spline {
    fn at(&self, t: f64) -> Smoothed {
        let Basis { first, values, slopes } = basis(self.start, self.width, self.intervals, t);
        let both = [values, slopes].map(|b| {
            let mut row = DVector::zeros(self.intervals + 3);
            row.as_mut_slice()[first..first + 4].copy_from_slice(&b);
            (row.dot(&self.coefficients), (self.variance * row.dot(&self.factor.solve(&row))).sqrt())
        });
        let [(value, value_sd), (slope, slope_sd)] = both;
        Smoothed { value, slope, value_sd, slope_sd }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reproduces_a_cubic_with_any_number_of_intervals() {
        let t: Vec<f64> = (0..100).map(|i| 1.0 + 0.05 * f64::from(i)).collect();
        let y: Vec<f64> = t.iter().map(|t| t * t * t - 4.0 * t).collect();
        let points = Points { t: &t, y: &y, weight: &[1.0; 100], effective: 100.0 };
        for m in [1, 4, 5] {
            let spline = Spline::fit(&points, Some(m)).unwrap();
            assert_eq!(spline.intervals(), m);
            for t in [1.0, 2.345, 5.95] {
                let at = spline.at(t);
                assert!((at.value - (t * t * t - 4.0 * t)).abs() < 1e-9);
                assert!((at.slope - (3.0 * t * t - 4.0)).abs() < 1e-8);
            }
        }
    }

    #[test]
    fn too_few_points_make_no_spline() {
        let t = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
        assert!(Spline::fit(&Points { t: &t, y: &t, weight: &[1.0; 7], effective: 7.0 }, None).is_none());
    }
}
