//! Sizes of what a law misses, on a ladder of values, with the covariance of all residuals for each size.

use nalgebra::{DMatrix, DVector};

use super::slow::Covariances;
use super::slow::Information;

/// Steps (rungs) of the ladder, each twice the one below.
const RUNGS: i32 = 9;
/// Smallest size on the ladder, as a part of the decay rate: averaging is of first order in the damping, and ring-downs of real structures repeat
/// worse than this. A judgement.
const DECAY_FLOOR: f64 = 2e-3;
/// Smallest size on the ladder, as a part of the frequency's shift, for the same reasons.
const SHIFT_FLOOR: f64 = 3e-3;
/// Smallest size on the ladder as a part of the frequency itself, for the same reasons; the larger of the two counts.
const FREQUENCY_FLOOR: f64 = 2e-6;

/// A size of the discrepancy: of the decay rate, relative, and of the frequency, in parts of its shift.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Size {
    pub(super) decay: f64,
    pub(super) omega: f64,
}

/// Makes residuals with a discrepancy of some size independent and of variance one.
#[derive(Debug, Clone)]
pub(super) struct Whitener {
    pub(super) size: Size,
    lower: DMatrix<f64>,
    /// ln of the determinant of the residuals' covariance.
    pub(super) log_determinant: f64,
}

impl Whitener {
    fn new(size: Size, covariance: DMatrix<f64>) -> Option<Self> {
        let lower = covariance.cholesky()?.l();
        let log_determinant = 2.0 * lower.diagonal().iter().map(|d| d.ln()).sum::<f64>();
        Some(Self { size, lower, log_determinant })
    }

    pub(super) fn vector(&self, y: &DVector<f64>) -> DVector<f64> {
        let mut out = y.clone();
        self.lower.solve_lower_triangular_mut(&mut out);
        out
    }

    pub(super) fn matrix(&self, y: &DMatrix<f64>) -> DMatrix<f64> {
        let mut out = y.clone();
        self.lower.solve_lower_triangular_mut(&mut out);
        out
    }
}

/// All sizes that are tried: every pair of a decay rate's and a frequency's.
#[derive(Debug, Clone)]
pub(super) struct Ladder {
    pub(super) rungs: Vec<Whitener>,
}

impl Ladder {
    /// The ladder for information about curves; `shift` and `frequency` are the range of the circular frequency and the frequency itself, 1/s. Errors
    /// of the covariance `always` are there at every size.
    pub(super) fn new(
        information: &Information,
        covariances: &Covariances,
        (shift, frequency): (f64, f64),
        always: &DMatrix<f64>,
    ) -> Option<Self> {
        let factor = &information.factor;
        let seen = covariances.each(|m| factor * m * factor.transpose());
        let rank = information.target.len();
        let mut base = DMatrix::identity(rank, rank);
        base += factor * always * factor.transpose();
        let floor = SHIFT_FLOOR.max(FREQUENCY_FLOOR * frequency / shift);
        let mut rungs = vec![];
        for i in 0..RUNGS {
            for j in 0..RUNGS {
                let size = Size { decay: DECAY_FLOOR * 2.0_f64.powi(i), omega: floor * 2.0_f64.powi(j) };
                let whole = &base + &seen.decay * size.decay.powi(2) + &seen.omega * size.omega.powi(2);
                rungs.push(Whitener::new(size, whole)?);
            }
        }
        Some(Self { rungs })
    }

    /// The rung with the least `criterion`, sought along one size, then along the other, until neither gains.
    pub(super) fn least(&self, criterion: impl Fn(&Whitener) -> f64) -> &Whitener {
        let side = RUNGS as usize;
        let mut known = vec![f64::NAN; self.rungs.len()];
        let mut value = |i: usize| {
            if known[i].is_nan() {
                known[i] = criterion(&self.rungs[i]);
            }
            known[i]
        };
        let (mut i, mut j) = (side / 2, side / 2);
        loop {
            let before = (i, j);
            i = (0..side).min_by(|a, b| value(a * side + j).total_cmp(&value(b * side + j))).unwrap_or(i);
            j = (0..side).min_by(|a, b| value(i * side + a).total_cmp(&value(i * side + b))).unwrap_or(j);
            if (i, j) == before {
                return &self.rungs[i * side + j];
            }
        }
    }

    /// The rung next to the root mean squares of the sizes, each rung weighted by its likelihood, and twice the negative logarithm of the mean
    /// likelihood: a size that happens to be likeliest near zero is not taken for certain.
    pub(super) fn typical(&self, criterion: impl Fn(&Whitener) -> f64) -> (&Whitener, f64) {
        let all: Vec<f64> = self.rungs.iter().map(criterion).collect();
        let least = all.iter().copied().fold(f64::INFINITY, f64::min);
        let (mut sum, mut decay, mut omega) = (0.0, 0.0, 0.0);
        for (rung, c) in self.rungs.iter().zip(&all) {
            let weight = (-0.5 * (c - least)).exp();
            sum += weight;
            decay += weight * rung.size.decay.powi(2);
            omega += weight * rung.size.omega.powi(2);
        }
        let mean = Size { decay: (decay / sum).sqrt(), omega: (omega / sum).sqrt() };
        let away =
            |w: &Whitener| (w.size.decay / mean.decay).ln().abs() + (w.size.omega / mean.omega).ln().abs();
        let next = self.rungs.iter().min_by(|a, b| away(a).total_cmp(&away(b))).unwrap_or(&self.rungs[0]);
        (next, least - 2.0 * (sum / all.len() as f64).ln())
    }
}
