//! Weighted least squares by polynomials that are orthogonal on the points themselves.
//!
//! G. E. Forsythe, Generation and use of orthogonal polynomials for data-fitting with a digital computer, J. SIAM 5(2), 74-88, 1957: the polynomials
//! follow from a three-term recurrence; with equal weights they are the discrete Legendre polynomials. Their coefficients do not change with the
//! order of the fit, and have independent errors.

use super::points::{Points, Smooth, Smoothed, Stretch};

/// Degrees above that of the fit whose coefficients count as its errors: at the ends, where all polynomials are largest, one or two more degrees
/// would change the curve by more than scatter does. The coefficient of one degree alone may be small by chance, where the curve is even or odd.
const LEFT_OUT: usize = 2;

/// A fitted polynomial.
#[derive(Debug, Clone)]
pub(crate) struct Polynomial {
    centre: f64,
    half: f64,
    /// One entry per degree.
    recurrence: Vec<Recurrence>,
    /// Coefficients of the fit, then those of the degrees above it.
    coefficients: Vec<f64>,
    /// Variances of the coefficients; for a degree that was left out, the square of its coefficient, which the curve lacks.
    variances: Vec<f64>,
    /// Degree of the fit.
    order: usize,
}

/// Recurrence p_{k+1} = (s - a) p_k - b p_{k-1} in scaled time s, from -1 to 1.
#[derive(Debug, Clone, Copy)]
struct Recurrence {
    a: f64,
    b: f64,
}

/// One of the polynomials at one time: its value, and its derivative with respect to scaled time.
#[derive(Debug, Clone, Copy)]
struct Term {
    value: f64,
    slope: f64,
}

impl Polynomial {
    /// The fit of the order, from 1 to `max`, for which Schwarz's criterion is least; or of the order `given`.
    pub(crate) fn fit(points: &Points<'_>, given: Option<usize>, max: usize) -> Self {
        let Stretch { middle: centre, half } = points.stretch();
        let most = points.t.len().saturating_sub(2);
        let max = given.unwrap_or(max).min(most);
        let above = (max + LEFT_OUT).min(most);
        let s: Vec<f64> = points.t.iter().map(|t| (t - centre) / half).collect();
        let (mut now, mut before) = (vec![1.0; s.len()], vec![0.0; s.len()]);
        let mut residual = points.y.to_vec();
        let mut fit =
            Self { centre, half, recurrence: vec![], coefficients: vec![], variances: vec![], order: 0 };
        let (mut norms, mut sums) = (Vec::new(), Vec::new());
        for k in 0..=above {
            let weighted =
                |f: &dyn Fn(usize) -> f64| -> f64 { (0..s.len()).map(|i| points.weight[i] * f(i)).sum() };
            let norm = weighted(&|i| now[i] * now[i]);
            let coefficient = weighted(&|i| now[i] * residual[i]) / norm;
            residual.iter_mut().zip(&now).for_each(|(r, p)| *r -= coefficient * p);
            sums.push(weighted(&|i| residual[i] * residual[i]));
            let a = weighted(&|i| s[i] * now[i] * now[i]) / norm;
            let b = if k == 0 { 0.0 } else { norm / norms[k - 1] };
            for i in 0..s.len() {
                let next = (s[i] - a) * now[i] - b * before[i];
                before[i] = std::mem::replace(&mut now[i], next);
            }
            norms.push(norm);
            fit.coefficients.push(coefficient);
            fit.recurrence.push(Recurrence { a, b });
        }
        let score = |k: usize| points.criterion(sums[k], k + 1);
        let best = (1..=max).min_by(|&i, &j| score(i).total_cmp(&score(j))).unwrap_or(max);
        let order = given.map_or(best, |_| max);
        let kept = (order + LEFT_OUT).min(above) + 1;
        fit.coefficients.truncate(kept);
        fit.recurrence.truncate(kept);
        let variance = points.variance(sums[order], order + 1);
        let of = |k: usize| if k <= order { variance / norms[k] } else { fit.coefficients[k].powi(2) };
        fit.variances = (0..kept).map(of).collect();
        fit.order = order;
        fit
    }

    /// The value of the curve alone, in a third of the time of [`Smooth::at`], with the same bits.
    pub(crate) fn value(&self, t: f64) -> f64 {
        let s = (t - self.centre) / self.half;
        let (mut now, mut before, mut sum) = (1.0, 0.0, 0.0);
        for (&Recurrence { a, b }, c) in self.recurrence.iter().zip(&self.coefficients).take(self.order + 1) {
            sum += c * now;
            (now, before) = ((s - a) * now - b * before, now);
        }
        sum
    }

    /// Degree of the polynomial.
    pub(crate) fn order(&self) -> usize {
        self.order
    }
}

impl Smooth for Polynomial {
    fn at(&self, t: f64) -> Smoothed {
        let s = (t - self.centre) / self.half;
        let (mut now, mut before) = (Term { value: 1.0, slope: 0.0 }, Term { value: 0.0, slope: 0.0 });
        let mut sum = [0.0; 4];
        for (k, ((&Recurrence { a, b }, c), v)) in
            self.recurrence.iter().zip(&self.coefficients).zip(&self.variances).enumerate()
        {
            let Term { value: p, slope: q } = now;
            let c = if k <= self.order { *c } else { 0.0 };
            let terms = [c * p, c * q, v * p * p, v * q * q];
            sum.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
            let next =
                Term { value: (s - a) * p - b * before.value, slope: p + (s - a) * q - b * before.slope };
            before = std::mem::replace(&mut now, next);
        }
        let [value, slope, value_variance, slope_variance] = sum;
        Smoothed {
            value,
            slope: slope / self.half,
            value_sd: value_variance.sqrt(),
            slope_sd: slope_variance.sqrt() / self.half,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times() -> Vec<f64> {
        (0..200).map(|i| 3.0 + 0.01 * f64::from(i) + 0.003 * f64::from(i % 3)).collect()
    }

    fn points<'a>(t: &'a [f64], y: &'a [f64], weight: &'a [f64]) -> Points<'a> {
        Points { t, y, weight, effective: t.len() as f64 }
    }

    #[test]
    fn a_cubic_is_found_exactly_and_its_order_as_well() {
        let t = times();
        let y: Vec<f64> = t.iter().map(|t| 1.0 - 2.0 * t + 0.5 * t * t * t).collect();
        let weight: Vec<f64> = t.iter().map(|t| (-3.0 * t).exp()).collect();
        let fit = Polynomial::fit(&points(&t, &y, &weight), None, 12);
        assert_eq!(fit.order(), 3);
        let at = fit.at(4.2);
        assert!((at.value - (1.0 - 8.4 + 0.5 * 4.2_f64.powi(3))).abs() < 1e-11);
        assert!((at.slope - (-2.0 + 1.5 * 4.2 * 4.2)).abs() < 1e-9);
    }

    #[test]
    fn standard_deviation_of_a_mean_is_sigma_over_root_n() {
        let t = times();
        let y: Vec<f64> = (0..200).map(|i| f64::from(1 - 2 * (i % 2))).collect();
        let fit = Polynomial::fit(&points(&t, &y, &[1.0; 200]), Some(0), 12);
        assert!((fit.at(4.0).value_sd - 1.0 / 199.0_f64.sqrt()).abs() < 1e-6);
    }

    #[test]
    fn high_orders_under_steep_weights_stay_accurate() {
        let t = times();
        let y: Vec<f64> = t.iter().map(|t| (2.0 * t).sin()).collect();
        let weight: Vec<f64> = t.iter().map(|t| (-6.0 * t).exp()).collect();
        let fit = Polynomial::fit(&points(&t, &y, &weight), Some(12), 12);
        for t in [3.0, 3.5, 4.0, 4.9] {
            assert!((fit.at(t).slope - 2.0 * (2.0 * t).cos()).abs() < 1e-6);
            assert_eq!(fit.value(t), fit.at(t).value);
        }
    }
}
