//! Moving least squares: a parabola through the neighbourhood of each point (W. S. Cleveland, J. Am. Stat. Assoc.
//! 74, 829, 1979, without the robustness passes).

use nalgebra::{Matrix3, Vector3};

use super::points::{Points, Smooth, Smoothed};

/// Points to which a parabola is fitted anew around every time that is asked for.
#[derive(Debug, Clone)]
pub(crate) struct LocalFit {
    t: Vec<f64>,
    y: Vec<f64>,
    weight: Vec<f64>,
    half: f64,
    /// Number of points over the number of independent ones.
    repeats: f64,
}

impl LocalFit {
    /// Neighbourhoods reach `half` (in the unit of time) to either side; at the ends of the points they still reach `half` inwards.
    pub(crate) fn new(points: &Points<'_>, half: f64) -> Self {
        let repeats = points.t.len() as f64 / points.effective;
        let (t, y, weight) = (points.t.to_vec(), points.y.to_vec(), points.weight.to_vec());
        Self { t, y, weight, half, repeats }
    }
}

impl Smooth for LocalFit {
    fn at(&self, t: f64) -> Smoothed {
        let from = self.t.partition_point(|s| *s <= t - self.half);
        let to = self.t.partition_point(|s| *s < t + self.half);
        let row = |i: usize| {
            let s = (self.t[i] - t) / self.half;
            let tricube = (1.0 - s.abs().powi(3)).powi(3);
            (Vector3::new(1.0, s, s * s), tricube * self.weight[i])
        };
        let (mut matrix, mut right, mut total) = (Matrix3::zeros(), Vector3::zeros(), Matrix3::zeros());
        for i in from..to {
            let (x, w) = row(i);
            matrix += w * x * x.transpose();
            total += w * w / self.weight[i] * x * x.transpose();
            right += w * self.y[i] * x;
        }
        let nothing = Smoothed { value: f64::NAN, slope: f64::NAN, value_sd: f64::NAN, slope_sd: f64::NAN };
        let Some(inverse) = matrix.try_inverse() else { return nothing };
        let c = inverse * right;
        let square = |i: usize| {
            let (x, w) = row(i);
            (w * (self.y[i] - x.dot(&c)).powi(2), w / self.weight[i])
        };
        let (rss, count) = (from..to).map(square).fold((0.0, 0.0), |s, x| (s.0 + x.0, s.1 + x.1));
        let variance = rss / (count / self.repeats - 3.0).max(1.0);
        let covariance = inverse * total * inverse * variance;
        Smoothed {
            value: c[0],
            slope: c[1] / self.half,
            value_sd: covariance[(0, 0)].max(0.0).sqrt(),
            slope_sd: covariance[(1, 1)].max(0.0).sqrt() / self.half,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_is_kept_up_to_the_ends() {
        let t: Vec<f64> = (0..100).map(f64::from).collect();
        let y: Vec<f64> = t.iter().map(|t| 2.0 + t - 0.1 * t * t).collect();
        let fit = LocalFit::new(&Points { t: &t, y: &y, weight: &[1.0; 100], effective: 50.0 }, 10.0);
        for t in [0.0, 33.3, 99.0] {
            assert!((fit.at(t).slope - (1.0 - 0.2 * t)).abs() < 1e-9);
            assert!((fit.at(t).value - (2.0 + t - 0.1 * t * t)).abs() < 1e-9);
        }
    }
}
