//! Fits of any model (minima, intervals, and what the data determine) against the closed forms of a straight line through noise.
#![allow(clippy::unwrap_used, reason = "a failed test may panic")]

use iwan_ident::Error;
use iwan_ident::estimate::{About, Found, Model, Told, intervals, least, near, silent};

/// The model y = a + b t + 0 c at t = 0, 1, …, in units of the noise.
struct Line {
    measured: Vec<f64>,
    bounds: [(f64, f64); 3],
    /// Whether the model returns values and derivatives; if not, every evaluation fails.
    known: bool,
}

const SAMPLES: usize = 20;

impl Line {
    fn new() -> Self {
        // Deviations that no straight line follows: they alternate in pairs.
        let off = |n: usize| if n % 4 < 2 { 1.0 } else { -1.0 };
        let measured = (0..SAMPLES).map(|n| 2.0 - 0.5 * n as f64 + off(n)).collect();
        Self { measured, bounds: [(-9.0, 9.0); 3], known: true }
    }
}

impl Model for Line {
    fn bounds(&self) -> &[(f64, f64)] {
        &self.bounds
    }

    fn count(&self) -> usize {
        self.measured.len()
    }

    fn evaluate(&self, x: &[f64], residuals: &mut [f64], slopes: Option<&mut [Vec<f64>]>) -> bool {
        for (n, (r, y)) in residuals.iter_mut().zip(&self.measured).enumerate() {
            *r = x[0] + x[1] * n as f64 - y;
        }
        if let Some([intercepts, slopes, silent]) = slopes {
            for (n, slope) in slopes.iter_mut().enumerate() {
                *slope = n as f64;
            }
            intercepts.fill(1.0);
            silent.fill(0.0);
        }
        self.known
    }
}

/// Intercept and slope of a linear regression, with their covariance.
fn regression(line: &Line) -> ([f64; 2], [[f64; 2]; 2]) {
    let n = line.count() as f64;
    let t = |i: usize| i as f64;
    let (s1, s2) = (0..line.count()).fold((0.0, 0.0), |(a, b), i| (a + t(i), b + t(i) * t(i)));
    let (y, ty) = line.measured.iter().enumerate().fold((0.0, 0.0), |(a, b), (i, y)| (a + y, b + t(i) * y));
    let det = n * s2 - s1 * s1;
    let best = [(s2 * y - s1 * ty) / det, (n * ty - s1 * y) / det];
    (best, [[s2 / det, -s1 / det], [-s1 / det, n / det]])
}

fn minimum(line: &Line) -> Found {
    least(line, &[vec![0.0, 0.0, 0.3], vec![5.0, -2.0, 0.3]], &[0, 1]).unwrap()
}

#[test]
fn the_least_sum_of_squares_of_a_line_is_its_regression() {
    let line = Line::new();
    let (best, _) = regression(&line);
    let found = minimum(&line);
    assert!(found.converged && found.x[2] == 0.3);
    for (found, expected) in found.x.iter().zip(best) {
        assert!((found - expected).abs() < 1e-7, "{found} {expected}");
    }
    let close = near(&line, &[0.0; 3], &[0, 1], (50, 1e-9)).unwrap();
    assert!((close.cost - found.cost).abs() < 1e-9 && close.x[2] == 0.0);
    let message = |e: Error| e.to_string();
    assert!(
        message(least(&line, &[], &[0]).unwrap_err()).contains("starts = 0 is out of range: at least one")
    );
    let short = Line { measured: vec![1.0], ..Line::new() };
    let refused = message(least(&short, &[vec![0.0; 3]], &[0, 1]).unwrap_err());
    assert!(refused.contains("residuals: 1 found, at least 2 needed; measure more"), "{refused}");
    let none = Line { known: false, ..Line::new() };
    let refused = message(least(&none, &[vec![0.0; 3]], &[0, 1]).unwrap_err());
    assert!(refused.contains("the start values have no model"), "{refused}");
    assert_eq!(near(&none, &[0.0; 3], &[0, 1], (5, 1e-3)), None);
}

/// The profiles of a line are parabolas. Their 95 % intervals are Student's quantile of 18 degrees of freedom times the standard deviation,
/// and open where a bound comes first or the data determine nothing. The ends were once off by a twentieth of the last step of their
/// search, which made intervals up to five per cent too narrow.
#[test]
fn intervals_of_a_line_are_students() {
    const QUANTILE: f64 = 2.100_922_040;
    let line = Line::new();
    let found = minimum(&line);
    let (best, covariance) = regression(&line);
    let variance = 0.7;
    let about = About { found: &found, free: &[0, 1], variance, settled: false };
    let ends = intervals(&line, about, &[0, 1], 2).unwrap();
    for (j, ends) in ends.iter().enumerate() {
        let half = QUANTILE * (variance * covariance[j][j]).sqrt();
        for (end, expected) in [(ends.low, best[j] - half), (ends.high, best[j] + half)] {
            assert!((end.unwrap() - expected).abs() < 5e-3 * half, "{j} {ends:?} {expected}");
        }
    }
    let narrow = Line { bounds: [(best[0] - 0.01, 9.0), (-9.0, 9.0), (-9.0, 9.0)], ..Line::new() };
    let ends = intervals(&narrow, about, &[0], 1).unwrap()[0];
    assert!(ends.low.is_none() && ends.high.is_some(), "{ends:?}");
    let silent = intervals(&line, About { settled: true, ..about }, &[2], 1).unwrap()[0];
    assert!(silent.low.is_none() && silent.high.is_none(), "{silent:?}");
    // A reported minimum that is none is left for the better point that the search for an interval meets.
    let poor = Found { x: vec![best[0] + 3.0, best[1], 0.3], cost: found.cost + 180.0, converged: true };
    let better = intervals(&line, About { found: &poor, ..about }, &[1], 1).unwrap_err();
    assert!(better.cost < poor.cost - 1.0, "{better:?}");
}

/// The covariance of the parameters from the curvature of the sum of squares is that of the regression, with the plausible deviation
/// (3.5) of the third parameter beside it.
#[test]
fn deviations_of_a_line_are_those_of_its_regression() {
    let line = Line::new();
    let found = minimum(&line);
    let (_, covariance) = regression(&line);
    let told = Told::about(&line, &found, &[0, 1], 1.0).unwrap();
    for (j, deviation) in told.deviations().iter().enumerate() {
        assert!((deviation / covariance[j][j].sqrt() - 1.0).abs() < 0.01, "{j} {deviation}");
    }
    // A prediction at t = 30: s² = C_aa + 2 t C_ab + t² C_bb.
    let t = 30.0;
    let expected = (covariance[0][0] + 2.0 * t * covariance[0][1] + t * t * covariance[1][1]).sqrt();
    assert!((told.deviation(&[1.0, t, 0.0]) / expected - 1.0).abs() < 0.01);
    // A point measured as well as the others is added: the regression of twenty-one values follows by an update of the inverse.
    let after = told.deviations_with(&[vec![1.0, t, 0.0]]);
    let gain = covariance[0][1] + t * covariance[1][1];
    let slope = (covariance[1][1] - gain * gain / (1.0 + expected * expected)).sqrt();
    assert!((after[1] / slope - 1.0).abs() < 0.01, "{after:?} {slope}");
    // The combination of parameters that is determined best has the smaller deviation; the product of both deviations is the root of the
    // determinant.
    let both: Vec<f64> = told.combinations().iter().map(|c| c.deviation).collect();
    let det = covariance[0][0] * covariance[1][1] - covariance[0][1] * covariance[1][0];
    assert!(both[0] < both[1] && (both[0] * both[1] / det.sqrt() - 1.0).abs() < 1e-9, "{both:?}");
    let length: f64 = told.combinations()[0].direction.iter().map(|d| d * d).sum();
    assert!((length - 1.0).abs() < 1e-12);
    // The parameter that the data do not determine keeps its plausible uncertainty, and is recognised as undetermined.
    let all = Told::about(&line, &found, &[0, 1, 2], 1.0).unwrap();
    assert!((all.deviations()[2] - 3.5).abs() < 1e-12);
    assert!(all.combinations()[2].deviation.is_infinite());
    assert_eq!(silent(&line, &found.x, 1.0).unwrap(), [2]);
    let none = Line { known: false, ..Line::new() };
    for error in
        [silent(&none, &found.x, 1.0).unwrap_err(), Told::about(&none, &found, &[0], 1.0).unwrap_err()]
    {
        assert!(error.to_string().contains("no derivatives; leave out the largest amplitudes"), "{error}");
    }
}
