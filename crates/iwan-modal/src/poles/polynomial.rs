//! Right matrix fractions by least squares: B. Peeters, H. Van der Auweraer, P. Guillaume, J. Leuridan, *The PolyMAX frequency-domain
//! method: a new standard for modal parameter estimation?*, Shock and Vibration 11:395, 2004.

use std::f64::consts::{PI, TAU};

use nalgebra::{Cholesky, DMatrix};
use rayon::prelude::*;
use rustfft::{Fft, FftPlanner};

use crate::error::Error;
use crate::fit::Band;
use crate::number::{Complex, complex};

/// Reduced normal equations from which the denominators of all orders follow.
pub(super) struct Denominator {
    /// Number of references, which is the size of the blocks.
    references: usize,
    /// For each order asked for, the sum over all outputs of T - Sᵀ R⁻¹ S. R⁻¹ of a lower order is not a part of that of a higher one, but the leading
    /// rows of L⁻¹ S are (R = L Lᵀ): from one order to the next the sum changes by the products of the new rows.
    normal: Vec<DMatrix<f64>>,
    /// Lowest frequency of the band, Hz, and (`interval`) the sampling interval whose Nyquist frequency is the width of the band, s.
    low: f64,
    interval: f64,
}

impl Denominator {
    /// The equations of responses in a band, for ascending orders; `matrix[output]` are the indices of the responses of one output to all references.
    pub(super) fn new(band: &Band, matrix: &[Vec<usize>], orders: &[usize]) -> Result<Self, Error> {
        let highest = orders.last().copied().unwrap_or(0);
        let noise = band.noise();
        let lines = band.lines();
        let (low, high) = band.edges();
        let weight: Vec<Complex> = band.weights.iter().map(|w| complex(w * w, 0.0)).collect();
        let transform = FftPlanner::new().plan_fft_forward(2 * (lines - 1));
        let lags = |x: &[Complex]| lags(x, highest, transform.as_ref());
        let own = lags(&weight);
        let toeplitz = DMatrix::from_fn(highest + 1, highest + 1, |i, j| own.at(i, j));
        let remedy = "lower --order, or widen the band";
        let factor = Cholesky::new(toeplitz).ok_or_else(|| {
            let finding = format!("{lines} lines do not carry polynomials of order {highest}");
            Error::refused("stabilisation chart", finding, remedy)
        })?;
        // One inverse for all outputs, because products of matrices are a few times faster than solutions; the matrix of weights is far from singular.
        let identity = DMatrix::identity(highest + 1, highest + 1);
        let inverse = factor.l().solve_lower_triangular(&identity).unwrap_or(identity);
        let references = matrix.first().map_or(1, Vec::len);
        let side = (highest + 1) * references;
        let value = |k: usize, c: usize| band.value(k, c) / noise[c].sqrt();
        let reduced = |responses: &Vec<usize>| {
            let mut cross = DMatrix::zeros(highest + 1, side);
            for (l, &c) in responses.iter().enumerate() {
                let sequence: Vec<Complex> = (0..lines).map(|k| value(k, c) * band.weights[k]).collect();
                let s = lags(&sequence);
                for i in 0..=highest {
                    for j in 0..=highest {
                        cross[(i, j * references + l)] = s.at(i, j);
                    }
                }
            }
            &inverse * cross
        };
        let reduced: Vec<DMatrix<f64>> = matrix.par_iter().map(reduced).collect();
        // The sum of T is linear in the products of responses, so that one transform serves all outputs.
        let mut moments = DMatrix::zeros(side, side);
        for l in 0..references {
            for m in 0..references {
                let product = |k: usize| -> Complex {
                    matrix.iter().map(|own| value(k, own[m]).conj() * value(k, own[l])).sum()
                };
                let t = lags(&(0..lines).map(product).collect::<Vec<_>>());
                for i in 0..=highest {
                    for j in 0..=highest {
                        moments[(i * references + m, j * references + l)] = t.at(i, j);
                    }
                }
            }
        }
        let normal = normal(moments, &reduced, orders, references);
        Ok(Self { references, normal, low, interval: 0.5 / (high - low) })
    }

    /// Poles (1/s, upper half plane, decaying) of the denominator of each order. Its last coefficient is fixed to one: poles that noise makes
    /// then grow instead of decaying, and are left out here.
    pub(super) fn poles(&self) -> Vec<Vec<Complex>> {
        self.normal.par_iter().map(|normal| self.of(normal)).collect()
    }

    fn of(&self, normal: &DMatrix<f64>) -> Vec<Complex> {
        let n = self.references;
        let order = normal.nrows() / n - 1;
        let free = order * n;
        let left = normal.view((0, 0), (free, free)).into_owned();
        let right = -normal.view((0, free), (free, n)).into_owned();
        let Some(coefficients) = solve(&left, right) else { return Vec::new() };
        // z^order = -Σ A_j z^j; the rows of the companion matrix are blocks.
        let mut companion = DMatrix::zeros(free, free);
        for j in 0..order {
            for a in 0..n {
                for b in 0..n {
                    companion[(free - n + a, j * n + b)] = -coefficients[(j * n + b, a)];
                }
            }
        }
        for i in 0..free - n {
            companion[(i, i + n)] = 1.0;
        }
        companion.complex_eigenvalues().iter().filter_map(|z| self.pole(*z)).collect()
    }

    /// The pole that belongs to a root z = e^(-(s - s_low) Δ), with Δ the interval; none where it grows or lies outside the band.
    fn pole(&self, z: Complex) -> Option<Complex> {
        let log = -z.ln();
        let inside = z.norm() > 1.0 && (0.0..=PI).contains(&log.im);
        inside.then(|| complex(log.re / self.interval, log.im / self.interval + TAU * self.low))
    }
}

/// The sums of T - Sᵀ R⁻¹ S for each of the ascending orders, from the sum of T over all outputs and from L⁻¹ S of each output.
fn normal(
    mut sum: DMatrix<f64>,
    reduced: &[DMatrix<f64>],
    orders: &[usize],
    references: usize,
) -> Vec<DMatrix<f64>> {
    let side = sum.nrows();
    let mut rows_taken = 0;
    let mut at = |order: &usize| {
        let own = (order + 1) * references;
        let new = order + 1 - rows_taken;
        let mut rows = DMatrix::zeros(new * reduced.len(), side);
        for (k, reduced) in reduced.iter().enumerate() {
            rows.rows_mut(k * new, new).copy_from(&reduced.rows(rows_taken, new));
        }
        rows_taken = order + 1;
        // Products of matrices are a few times faster than those of columns.
        sum -= rows.transpose() * &rows;
        sum.view((0, 0), (own, own)).into_owned()
    };
    orders.iter().map(&mut at).collect()
}

fn solve(left: &DMatrix<f64>, right: DMatrix<f64>) -> Option<DMatrix<f64>> {
    let n = left.nrows();
    let scale: Vec<f64> = (0..n).map(|i| left[(i, i)].max(f64::MIN_POSITIVE).sqrt().recip()).collect();
    let scaled = DMatrix::from_fn(n, n, |i, j| left[(i, j)] * scale[i] * scale[j]);
    let mut b = right;
    scale.iter().enumerate().for_each(|(i, s)| b.row_mut(i).scale_mut(*s));
    // Without noise the matrix is singular above the true order; the solution is then of no use, and none is returned.
    let mut x = scaled.lu().solve(&b)?;
    scale.iter().enumerate().for_each(|(i, s)| x.row_mut(i).scale_mut(*s));
    x.iter().all(|v| v.is_finite()).then_some(x)
}

/// Real parts of Σ x_k z_k^m for all |m| up to an order, with z_k = e^(-iπ k/(lines - 1)).
struct Lags {
    /// For m from 0 upwards.
    forward: Vec<f64>,
    /// For m from 0 downwards.
    backward: Vec<f64>,
}

impl Lags {
    /// Entry of the Toeplitz matrix that belongs to conj(z^i) z^j.
    fn at(&self, i: usize, j: usize) -> f64 {
        if j >= i { self.forward[j - i] } else { self.backward[i - j] }
    }
}

/// The sums for the values `x` at the lines, by `transform`, which has the length 2 (lines - 1).
fn lags(x: &[Complex], highest: usize, transform: &dyn Fft<f64>) -> Lags {
    let length = transform.len();
    let mut buffer = x.to_vec();
    buffer.resize(length, complex(0.0, 0.0));
    transform.process(&mut buffer);
    let forward = (0..=highest).map(|m| buffer[m % length].re).collect();
    let backward = (0..=highest).map(|m| buffer[(length - m % length) % length].re).collect();
    Lags { forward, backward }
}
