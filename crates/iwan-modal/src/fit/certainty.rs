//! Standard deviations of poles and residues, to first order in the noise.

use nalgebra::{Cholesky, DMatrix};
use rayon::prelude::*;

use super::band::Band;
use super::linear::Linear;
use crate::number::Complex;

/// Covariances of fitted poles and residues.
#[derive(Debug, Clone, PartialEq)]
pub struct Certainty {
    /// Covariance of the real and imaginary parts of the poles in turn, 1/s².
    poles: DMatrix<f64>,
    /// Covariance of real and imaginary part of each residue: `residues[pole][response]` = (variance of re, variance of im, covariance).
    residues: Vec<Vec<[f64; 3]>>,
}

impl Certainty {
    /// Covariances at the fitted `poles`; `noise` is the variance of each response's entries.
    pub(super) fn new(band: &Band, poles: &[Complex], linear: &Linear, noise: &[f64]) -> Self {
        let precision: Vec<f64> = noise.iter().map(|v| v.recip()).collect();
        let n = poles.len();
        let Some(slopes) = &linear.slopes else {
            return Self { poles: DMatrix::zeros(0, 0), residues: Vec::new() };
        };
        let (matrix, _) = slopes.normal(linear, &precision);
        let scale: Vec<f64> =
            (0..2 * n).map(|i| matrix[(i, i)].max(f64::MIN_POSITIVE).sqrt().recip()).collect();
        let scaled = DMatrix::from_fn(2 * n, 2 * n, |i, j| matrix[(i, j)] * scale[i] * scale[j]);
        let inverse = Cholesky::new(scaled)
            .map_or_else(|| DMatrix::from_element(2 * n, 2 * n, f64::INFINITY), |c| c.inverse());
        let covariance = DMatrix::from_fn(2 * n, 2 * n, |i, j| inverse[(i, j)] * scale[i] * scale[j]);
        let residues = |p: usize| {
            let of = |c: usize| residue(linear, &slopes.follow, &covariance, noise[c], p, c);
            (0..band.values.ncols()).map(of).collect()
        };
        Self { residues: (0..n).into_par_iter().map(residues).collect(), poles: covariance }
    }

    /// Variances of a pole's real and imaginary part and their covariance, 1/s².
    #[must_use]
    pub fn pole(&self, pole: usize) -> [f64; 3] {
        let i = 2 * pole;
        [self.poles[(i, i)], self.poles[(i + 1, i + 1)], self.poles[(i, i + 1)]]
    }

    /// Variances of a residue's real and imaginary part and their covariance.
    #[must_use]
    pub fn residue(&self, pole: usize, response: usize) -> [f64; 3] {
        self.residues[pole][response]
    }
}

/// Covariance of one residue: it is uncertain by the noise of its response and because it follows all poles, δR = Φ⁺ δy - Φ⁺ W δp.
fn residue(
    linear: &Linear,
    follow: &DMatrix<f64>,
    poles: &DMatrix<f64>,
    noise: f64,
    p: usize,
    c: usize,
) -> [f64; 3] {
    let count = poles.nrows();
    let along = |row: usize| -> Vec<f64> {
        let one = |k: usize| {
            let (q, r) = (k / 2, linear.residue(k / 2, c));
            let [a, b] = if k.is_multiple_of(2) { [r.re, r.im] } else { [-r.im, r.re] };
            a * follow[(row, 2 * q)] + b * follow[(row, 2 * q + 1)]
        };
        (0..count).map(one).collect()
    };
    let (re, im) = (along(2 * p), along(2 * p + 1));
    let times = |y: &[f64]| -> Vec<f64> {
        poles.column_iter().map(|column| column.iter().zip(y).map(|(a, b)| a * b).sum()).collect()
    };
    let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(a, b)| a * b).sum::<f64>();
    let (of_re, of_im) = (times(&re), times(&im));
    let own = |i: usize, j: usize| noise * linear.inverse[(2 * p + i, 2 * p + j)];
    [own(0, 0) + dot(&re, &of_re), own(1, 1) + dot(&im, &of_im), own(0, 1) + dot(&re, &of_im)]
}
