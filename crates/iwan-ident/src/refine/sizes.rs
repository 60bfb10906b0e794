//! How large the discrepancies are: variance components by restricted maximum likelihood.
//!
//! Residuals at the best fit, r = J dx + Σ s_i Z_i u_i + e with u and e of variance one: J's part is projected out, and the sizes
//! s_i maximise the likelihood of what is left, whose own variance is profiled out (H. D. Patterson, R. Thompson, Biometrika
//! 58:545, 1971). Where the residuals are white all sizes come out as zero or next to it.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt;
use faer::{Mat, Par, Spec};
use nalgebra::{DMatrix, DVector};

/// Sizes that are tried first, in units of the values' own: a hundredth of a per cent to 30 %, in steps that the search halves.
const FIRST: [f64; 6] = [1e-5, 1e-4, 1e-3, 1e-2, 0.1, 0.3];
/// Rounds of the search over the logarithms of all sizes; each halves its step where none of its trials is better.
const ROUNDS: usize = 60;
/// First and last step of that search, in ln: a size need not be known better than to a tenth.
const STEP: f64 = 1.2;
const LAST_STEP: f64 = 0.1;
/// Gain of the log likelihood below which a process is left out. Twice the gain by noise alone is zero for half of the records and χ² with one degree of
/// freedom for the others (S. G. Self, K.-Y. Liang, J. Am. Stat. Assoc. 82:605, 1987): it passes 4 in 2 records of 100.
const GAIN: f64 = 2.0;

/// Sizes over which the mean is taken: from the smallest to the largest of these, in units of the values' own, …
const MEAN_OVER: [f64; 2] = [1e-6, 1.0];
/// … in so many steps of the logarithm: a factor of 1.4 each.
const MEAN_STEPS: usize = 40;

/// The sizes, and what follows from them.
pub(super) struct Likeliest {
    /// Of each process, in units of its values.
    pub(super) sizes: Vec<f64>,
    /// All values that are expected.
    pub(super) expected: DVector<f64>,
    /// Number of values that the residuals tell, of all.
    pub(super) explained: f64,
    /// ln of the restricted likelihood up to a constant.
    pub(super) likelihood: f64,
}

/// Triangular factor of a symmetric positive definite matrix: of several hundred rows for a dozen records, where blocked factors are ten times as fast as plain ones.
struct Factors(Mat<f64>);

impl Factors {
    /// None where the matrix is not positive definite.
    fn new(mut matrix: Mat<f64>) -> Option<Self> {
        let spec = Spec::default();
        let mut buffer =
            MemBuffer::new(llt::factor::cholesky_in_place_scratch::<f64>(matrix.nrows(), Par::Seq, spec));
        let (none, stack) = (llt::factor::LltRegularization::default(), MemStack::new(&mut buffer));
        llt::factor::cholesky_in_place(matrix.as_mut(), none, Par::Seq, stack, spec).ok()?;
        Some(Self(matrix))
    }

    /// The matrix's inverse times columns.
    fn inverse_times(&self, mut columns: Mat<f64>) -> Mat<f64> {
        let (n, width) = (columns.nrows(), columns.ncols());
        let mut buffer = MemBuffer::new(llt::solve::solve_in_place_scratch::<f64>(n, width, Par::Seq));
        llt::solve::solve_in_place(self.0.as_ref(), columns.as_mut(), Par::Seq, MemStack::new(&mut buffer));
        columns
    }

    fn solved(&self, right: &DVector<f64>) -> DVector<f64> {
        let solved = self.inverse_times(Mat::from_fn(right.len(), 1, |i, _| right[i]));
        DVector::from_fn(right.len(), |i, _| solved[(i, 0)])
    }

    fn ln_determinant(&self) -> f64 {
        (0..self.0.nrows()).map(|i| 2.0 * self.0[(i, i)].ln()).sum()
    }

    fn trace_of_inverse(&self) -> f64 {
        let n = self.0.nrows();
        let inverse = self.inverse_times(Mat::identity(n, n));
        (0..n).map(|i| inverse[(i, i)]).sum()
    }
}

/// What is left of the residuals and of the processes' columns behind the projection.
pub(super) struct Projected {
    /// Sums of products of all columns, …
    gram: DMatrix<f64>,
    /// … of columns and residuals, …
    product: DVector<f64>,
    /// … and of the residuals with themselves.
    square: f64,
    /// Degrees of freedom.
    freedom: f64,
    /// Number of columns of each process.
    widths: Vec<usize>,
    /// Size of a process that is expected before the residuals are seen.
    typical: f64,
}

impl Projected {
    /// Residuals `r` and the columns of processes, without what the `jacobian` of the sought parameters explains.
    pub(super) fn new(jacobian: DMatrix<f64>, r: &[f64], processes: &[&DMatrix<f64>], typical: f64) -> Self {
        let unknowns = jacobian.ncols();
        let widths: Vec<usize> = processes.iter().map(|z| z.ncols()).collect();
        let total: usize = widths.iter().sum();
        let mut columns = DMatrix::zeros(r.len(), total + 1);
        let mut from = 0;
        for z in processes {
            columns.columns_mut(from, z.ncols()).copy_from(*z);
            from += z.ncols();
        }
        columns.column_mut(total).copy_from_slice(r);
        jacobian.qr().q_tr_mul(&mut columns);
        let left = columns.rows(unknowns, r.len() - unknowns);
        let gram = left.tr_mul(&left);
        Self {
            product: gram.view((0, total), (total, 1)).column(0).into_owned(),
            square: gram[(total, total)],
            gram: gram.view((0, 0), (total, total)).into_owned(),
            freedom: (r.len() - unknowns) as f64,
            widths,
            typical,
        }
    }

    /// Each column's size.
    fn spread(&self, sizes: &[f64]) -> DVector<f64> {
        let all = self.widths.iter().zip(sizes).flat_map(|(n, s)| std::iter::repeat_n(*s, *n));
        DVector::from_iterator(self.widths.iter().sum(), all)
    }

    /// Factors of 1 + S G S with the columns' sizes S.
    fn factors(&self, s: &DVector<f64>) -> Option<Factors> {
        let entry = |i, j| s[i] * self.gram[(i, j)] * s[j] + f64::from(u8::from(i == j));
        Factors::new(Mat::from_fn(s.len(), s.len(), entry))
    }

    /// ln of the restricted likelihood up to a constant, for sizes relative to the residuals' standard deviation; and that deviation.
    fn likelihood(&self, sizes: &[f64]) -> Option<(f64, f64)> {
        let s = self.spread(sizes);
        let factors = self.factors(&s)?;
        let scaled = s.component_mul(&self.product);
        let explained = scaled.dot(&factors.solved(&scaled));
        let square = (self.square - explained).max(f64::EPSILON * self.square);
        let likelihood = -0.5 * (self.freedom * square.ln() + factors.ln_determinant());
        Some((likelihood, (square / self.freedom).sqrt()))
    }

    fn score(&self, sizes: &[f64]) -> f64 {
        let Some((likelihood, deviation)) = self.likelihood(sizes) else { return f64::NEG_INFINITY };
        let prior: f64 = sizes.iter().map(|s| s * deviation / self.typical).sum();
        likelihood - prior
    }

    /// The sizes at which the restricted likelihood is largest, zero for processes that add nothing.
    pub(super) fn sizes(&self) -> Option<Likeliest> {
        let relative = self.likeliest();
        let (_, deviation) = self.likelihood(&relative)?;
        let s = self.spread(&relative);
        let factors = self.factors(&s)?;
        Some(Likeliest {
            likelihood: self.score(&relative),
            sizes: relative.iter().map(|size| size * deviation).collect(),
            expected: s.component_mul(&factors.solved(&s.component_mul(&self.product))),
            explained: s.len() as f64 - factors.trace_of_inverse(),
        })
    }

    /// The mean of each size over what the residuals allow and what is expected before they are seen, the others at their likeliest.
    pub(super) fn expected_sizes(&self) -> Option<Vec<f64>> {
        let likeliest = self.likeliest();
        let (_, deviation) = self.likelihood(&likeliest)?;
        let [low, high] = MEAN_OVER.map(|size: f64| (size / deviation).ln());
        let trials: Vec<f64> =
            (0..=MEAN_STEPS).map(|k| (low + (high - low) * k as f64 / MEAN_STEPS as f64).exp()).collect();
        let one = |i: usize| {
            let score = |size: f64| {
                let mut sizes = likeliest.clone();
                sizes[i] = size;
                self.score(&sizes)
            };
            let scores: Vec<f64> = trials.iter().map(|t| score(*t)).collect();
            let top = scores.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            // Steps of the logarithm are the longer the larger the size.
            let weights = || trials.iter().zip(&scores).map(|(t, s)| (t, t * (s - top).exp()));
            let mean = weights().map(|(t, w)| t * w).sum::<f64>() / weights().map(|(_, w)| w).sum::<f64>();
            mean * deviation
        };
        let mean: Vec<f64> = (0..likeliest.len()).map(one).collect();
        mean.iter().all(|m| m.is_finite()).then_some(mean)
    }

    /// The same sizes relative to the residuals' standard deviation.
    fn likeliest(&self) -> Vec<f64> {
        let count = self.widths.len();
        let score = |sizes: &[f64]| self.score(sizes);
        let none = vec![0.0; count];
        let deviation = self.likelihood(&none).map_or(1.0, |l| l.1);
        // All processes alike, and each one alone beside next to nothing: what one of them explains others explain in part, and the way from one to another leads
        // through less likely sizes.
        let size = |first: f64, own: Option<usize>| -> Vec<f64> {
            (0..count)
                .map(|i| if own.is_none_or(|own| own == i) { first } else { FIRST[0] } / deviation)
                .collect()
        };
        let alone = (0..count).filter(|_| count > 1).map(Some);
        let starts = std::iter::once(None).chain(alone).flat_map(|own| FIRST.map(|first| size(first, own)));
        let scored = starts.map(|sizes| (score(&sizes), sizes));
        let best = scored.max_by(|a, b| a.0.total_cmp(&b.0));
        let (mut top, mut best) = best.unwrap_or_else(|| (score(&none), none.clone()));
        let mut step = STEP;
        for _ in 0..ROUNDS {
            let before = top;
            for i in 0..count {
                for sign in [-1.0, 1.0] {
                    let mut other = best.clone();
                    other[i] *= (sign * step).exp();
                    let likelihood = score(&other);
                    if likelihood > top {
                        (best, top) = (other, likelihood);
                    }
                }
            }
            if top <= before {
                step *= 0.5;
            }
            if step < LAST_STEP {
                break;
            }
        }
        for i in 0..count {
            let mut without = best.clone();
            without[i] = 0.0;
            let likelihood = score(&without);
            if likelihood > top - GAIN {
                (best, top) = (without, likelihood);
            }
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_solve_and_have_determinant_and_trace() {
        let root = DMatrix::from_fn(5, 5, |i, j| ((3 * i + 7 * j) as f64).sin());
        let matrix = DMatrix::identity(5, 5) + &root * root.transpose();
        let factors = Factors::new(Mat::from_fn(5, 5, |i, j| matrix[(i, j)])).unwrap();
        let right = DVector::from_fn(5, |i, _| i as f64 - 1.5);
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-12 * b.abs().max(1.0), "{a} {b}");
        close((&matrix * factors.solved(&right) - right).norm(), 0.0);
        close(factors.ln_determinant(), matrix.determinant().ln());
        close(factors.trace_of_inverse(), matrix.clone().try_inverse().unwrap().trace());
        assert!(Factors::new(Mat::from_fn(5, 5, |i, j| -matrix[(i, j)])).is_none());
    }
}
