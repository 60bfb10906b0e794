//! How large the discrepancies are: variance components by restricted maximum likelihood.
//!
//! Residuals at the best fit are r = J dx + Σ s_i Z_i u_i + e, with u and e of variance one, the derivatives J with respect to the sought parameters,
//! and the columns Z_i of process i. What J explains is projected out; the sizes s_i maximise the likelihood of what is left, and the variance of e
//! is profiled out (H. D. Patterson, R. Thompson, Biometrika 58:545, 1971). Where the residuals are white all sizes come out as zero or next to it.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor as llt;
use faer::{Par, Spec};
use iwan_machine::memory::is_address_space_bounded;
use nalgebra::{DMatrix, DVector};

use crate::search::{blocked, triangular};

/// Sizes that are tried first, in units of the processes' values: a thousandth of a per cent to 30 %. The search goes on from the best of them by
/// smaller steps (`STEP`).
const FIRST: [f64; 6] = [1e-5, 1e-4, 1e-3, 1e-2, 0.1, 0.3];
/// Most rounds of the search over the logarithms of all sizes; a round without a better trial halves the step. Where they are spent the best trial so
/// far counts.
const ROUNDS: usize = 60;
/// First and last step of that search, in ln size: a size need not be known better than to a tenth.
const STEP: f64 = 1.2;
const LAST_STEP: f64 = 0.1;
/// Gain of the log likelihood below which a process is left out (its size becomes zero). Twice the gain by noise alone is zero for half of the
/// records and χ² with one degree of freedom for the others (S. G. Self, K.-Y. Liang, J. Am. Stat. Assoc. 82:605, 1987): it passes 4 in 2 records of
/// 100.
const GAIN: f64 = 2.0;

/// Smallest and largest size over which the mean size is taken, in units of the processes' values.
const MEAN_OVER: [f64; 2] = [1e-6, 1.0];
/// Steps between these two, equal in the logarithm: a factor of 1.4 each.
const MEAN_STEPS: usize = 40;

/// The likeliest sizes, and what follows from them.
pub(super) struct Likeliest {
    /// Size of each process, in units of its values.
    pub(super) sizes: Vec<f64>,
    /// Expected values s_i u_i of the processes, one per column.
    pub(super) expected: DVector<f64>,
    /// How many of these values the residuals determine: the degrees of freedom that the processes take.
    pub(super) explained: f64,
    /// ln of the restricted likelihood, less the penalty on large sizes, up to a constant.
    pub(super) likelihood: f64,
}

/// Lower triangular factor of a symmetric positive definite matrix.
struct Factors(DMatrix<f64>);

impl Factors {
    /// None where the matrix is not positive definite.
    fn new(mut matrix: DMatrix<f64>) -> Option<Self> {
        if is_address_space_bounded() {
            return matrix.cholesky().map(|factors| Self(factors.unpack()));
        }
        let (n, spec) = (matrix.nrows(), Spec::default());
        let mut buffer = MemBuffer::new(llt::cholesky_in_place_scratch::<f64>(n, Par::Seq, spec));
        let (none, stack) = (llt::LltRegularization::default(), MemStack::new(&mut buffer));
        llt::cholesky_in_place(blocked(&mut matrix), none, Par::Seq, stack, spec).ok()?;
        matrix.fill_upper_triangle(0.0, 1);
        Some(Self(matrix))
    }

    fn solved(&self, right: &DVector<f64>) -> DVector<f64> {
        let mut solved = right.clone();
        self.0.solve_lower_triangular_unchecked_mut(&mut solved);
        self.0.tr_solve_lower_triangular_unchecked_mut(&mut solved);
        solved
    }

    fn ln_determinant(&self) -> f64 {
        self.0.diagonal().iter().map(|d| 2.0 * d.ln()).sum()
    }

    fn trace_of_inverse(&self) -> f64 {
        let mut inverse = DMatrix::identity(self.0.nrows(), self.0.nrows());
        self.0.solve_lower_triangular_unchecked_mut(&mut inverse);
        inverse.norm_squared()
    }
}

/// What is left of the residuals and of the processes' columns after the projection.
pub(super) struct Projected {
    /// Products of all columns with each other.
    gram: DMatrix<f64>,
    /// Products of the columns with the residuals.
    product: DVector<f64>,
    /// Sum of squares of the residuals.
    square: f64,
    /// Degrees of freedom of the residuals.
    freedom: f64,
    /// Number of columns of each process.
    widths: Vec<usize>,
    /// Size of a process that is expected before the residuals are seen.
    typical: f64,
}

impl Projected {
    /// Takes from the residuals `r` and from the columns of the processes what the `jacobian` of the sought parameters explains.
    pub(super) fn new(jacobian: &DMatrix<f64>, r: &[f64], processes: &[&DMatrix<f64>], typical: f64) -> Self {
        let unknowns = jacobian.ncols();
        let widths: Vec<usize> = processes.iter().map(|z| z.ncols()).collect();
        let total: usize = widths.iter().sum();
        let mut columns = DMatrix::zeros(r.len(), unknowns + total + 1);
        columns.columns_mut(0, unknowns).copy_from(jacobian);
        let mut from = unknowns;
        for z in processes {
            columns.columns_mut(from, z.ncols()).copy_from(*z);
            from += z.ncols();
        }
        columns.column_mut(from).copy_from_slice(r);
        let factor = triangular(columns);
        // Below the rows of the Jacobian's own factor stands the factor of what the Jacobian does not explain; a column without effect has no row.
        let is_own = |row: &usize| factor.row(*row).columns(0, unknowns).amax() > 0.0;
        let first = (0..unknowns.min(factor.nrows())).rev().find(is_own).map_or(0, |row| row + 1);
        let left = factor.view((first, unknowns), (factor.nrows() - first, total + 1));
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

    /// The size of each column, which is that of its process.
    fn spread(&self, sizes: &[f64]) -> DVector<f64> {
        let all = self.widths.iter().zip(sizes).flat_map(|(n, s)| std::iter::repeat_n(*s, *n));
        DVector::from_iterator(self.widths.iter().sum(), all)
    }

    /// Factors of 1 + S G S, with the columns' sizes S on a diagonal and the products G of the columns.
    fn factors(&self, s: &DVector<f64>) -> Option<Factors> {
        let entry = |i, j| s[i] * self.gram[(i, j)] * s[j] + f64::from(u8::from(i == j));
        Factors::new(DMatrix::from_fn(s.len(), s.len(), entry))
    }

    /// ln of the restricted likelihood up to a constant, for sizes relative to the residuals' standard deviation; and this standard deviation.
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

    /// The sizes at which the restricted likelihood, with its penalty, is largest; zero for processes that add nothing.
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

    /// The mean of each size, weighted by its likelihood and by what is expected before the residuals are seen; the other sizes are held at their
    /// likeliest values.
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
            // Equal steps of the logarithm are the longer the larger the size, hence the factor t.
            let weights = || trials.iter().zip(&scores).map(|(t, s)| (t, t * (s - top).exp()));
            let mean = weights().map(|(t, w)| t * w).sum::<f64>() / weights().map(|(_, w)| w).sum::<f64>();
            mean * deviation
        };
        let mean: Vec<f64> = (0..likeliest.len()).map(one).collect();
        mean.iter().all(|m| m.is_finite()).then_some(mean)
    }

    /// The likeliest sizes, relative to the residuals' standard deviation.
    fn likeliest(&self) -> Vec<f64> {
        let count = self.widths.len();
        let score = |sizes: &[f64]| self.score(sizes);
        let none = vec![0.0; count];
        let deviation = self.likelihood(&none).map_or(1.0, |l| l.1);
        // All processes alike, and each process alone with the others next to nothing: what one process explains others explain in part, and the way
        // from one to another leads through less likely sizes.
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
    fn what_the_parameters_explain_is_projected_out() {
        let column = |k: usize| DMatrix::from_fn(40, 3, move |i, j| ((i * (k + j + 1)) as f64).cos());
        let (jacobian, process) = (column(0), column(5));
        let r: Vec<f64> = (0..40).map(|i| (0.3 * f64::from(i)).sin()).collect();
        let q = jacobian.clone().qr().q();
        let left = |x: DMatrix<f64>| &x - &q * q.tr_mul(&x);
        let (z, e) = (left(process.clone()), left(DMatrix::from_column_slice(40, 1, &r)));
        // A column without effect changes nothing.
        let with_zero = jacobian.clone().insert_column(1, 0.0);
        for jacobian in [&jacobian, &with_zero] {
            let projected = Projected::new(jacobian, &r, &[&process], 1.0);
            assert!((projected.gram - z.tr_mul(&z)).norm() < 1e-12);
            assert!((projected.product - z.tr_mul(&e).column(0)).norm() < 1e-12);
            assert!((projected.square - e.norm_squared()).abs() < 1e-12);
        }
    }

    #[test]
    fn factors_solve_and_have_determinant_and_trace() {
        let root = DMatrix::from_fn(5, 5, |i, j| ((3 * i + 7 * j) as f64).sin());
        let matrix = DMatrix::identity(5, 5) + &root * root.transpose();
        let factors = Factors::new(matrix.clone()).unwrap();
        let right = DVector::from_fn(5, |i, _| i as f64 - 1.5);
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-12 * b.abs().max(1.0), "{a} {b}");
        close((&matrix * factors.solved(&right) - right).norm(), 0.0);
        close(factors.ln_determinant(), matrix.determinant().ln());
        close(factors.trace_of_inverse(), matrix.clone().try_inverse().unwrap().trace());
        assert!(Factors::new(-matrix).is_none());
    }
}
