//! Residuals of points about a smooth curve, and how far they are from even, independent scatter.

use super::traces::Trace;
use crate::smooth::Smooth;

/// Residuals along time, scaled to weight 1.
#[derive(Debug, Clone)]
pub(super) struct Residuals {
    t: Vec<f64>,
    /// Sum of squares of the residuals before each point, and of all at the end; the first is 0.
    sums: Vec<f64>,
    /// Factor by which the residuals' correlation widens variances, beyond the correlation that the filter makes; at least 1.
    slow: f64,
}

impl Residuals {
    /// Residuals of a curve through weighted points, of which the filter leaves `effective` independent.
    pub(super) fn new(trace: &Trace, weight: &[f64], curve: &dyn Smooth, effective: f64) -> Self {
        let point = |i: usize| weight[i].sqrt() * (trace.y[i] - curve.at(trace.t[i]).value);
        let values: Vec<f64> = (0..trace.t.len()).map(point).collect();
        let mut sums = vec![0.0];
        sums.extend(values.iter().scan(0.0, |sum, r| {
            *sum += r * r;
            Some(*sum)
        }));
        let repeats = values.len() as f64 / effective;
        Self { t: trace.t.clone(), slow: (widening(&values) / repeats).max(1.0), sums }
    }

    /// Factor on standard deviations at the time `t` (s): for the residuals' correlation, and for their size within `reach` (s) of `t` where it is larger than over the whole.
    pub(super) fn inflation(&self, t: f64, reach: f64) -> f64 {
        let from = self.t.partition_point(|s| *s < t - reach);
        let to = self.t.partition_point(|s| *s <= t + reach);
        let all = self.sums[self.t.len()] / self.t.len() as f64;
        let here = (self.sums[to] - self.sums[from]) / (to - from).max(1) as f64;
        let uneven = if all > 0.0 { (here / all).max(1.0) } else { 1.0 };
        (self.slow * uneven).sqrt()
    }
}

/// 1 + 2 Σ of the residuals' correlation at all lags up to the first at which it is negative.
fn widening(r: &[f64]) -> f64 {
    let square: f64 = r.iter().map(|r| r * r).sum();
    if square == 0.0 {
        return 1.0;
    }
    let at = |lag: usize| r.iter().zip(&r[lag..]).map(|(a, b)| a * b).sum::<f64>() / square;
    1.0 + 2.0 * (1..r.len()).map(at).take_while(|c| *c > 0.0).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::smooth::{Points, Polynomial};
    use iwan_core::SplitMix64;

    fn line(y: impl Fn(usize, f64) -> f64) -> Residuals {
        let mut random = SplitMix64::new(3);
        let trace: Trace = (0..400).map(|i| (i as f64, y(i, random.next_symmetric()))).collect();
        let weight = vec![1.0; 400];
        let points = Points { t: &trace.t, y: &trace.y, weight: &weight, effective: 400.0 };
        Residuals::new(&trace, &weight, &Polynomial::fit(&points, Some(1), 1), 400.0)
    }

    #[test]
    fn even_scatter_is_left_alone_and_uneven_or_slow_scatter_is_not() {
        let even = line(|_, random| random);
        assert!(even.inflation(200.0, 40.0) < 1.5 && even.inflation(0.0, 40.0) < 1.5);
        let begins = line(|i, random| if i < 40 { 5.0 * random } else { random });
        assert!(begins.inflation(0.0, 40.0) > 2.0 && begins.inflation(300.0, 40.0) < 1.5);
        // A wave that bends where the fit is straight: half waves of a hundred points.
        let bends = line(|i, random| (i as f64 * 0.03).sin() + 0.01 * random);
        assert!(bends.inflation(200.0, 40.0) > 5.0);
        // Nothing left is nothing to widen.
        let exact = Residuals { t: vec![0.0, 1.0], sums: vec![0.0; 3], slow: 1.0 };
        assert_eq!(exact.inflation(0.5, 1.0), 1.0);
    }
}
