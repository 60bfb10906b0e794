//! The curves of decay rate and frequency, and what laws miss of them, as Gaussian processes of ln a.
//!
//! C. E. Rasmussen and C. K. I. Williams, Gaussian Processes for Machine Learning, 2006, Sec. 2.7 (a straight line of unknown
//! coefficients beneath the process) and 5.4.1 (sizes by the marginal likelihood); as a discrepancy of a law: M. C. Kennedy and A.
//! O'Hagan, Bayesian calibration of computer models, J. R. Statist. Soc. B 63:425, 2001.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::flow::Rates;
use super::grid::Grid;

/// Length over which a process keeps its value, in ln amplitude: a factor e. The process is Ornstein and Uhlenbeck's, which may bend anywhere. A
/// smooth process (a squared exponential) has to grow to half the damping before it follows the small bends of measured curves, and then follows
/// everything by which laws are told apart. With a third of this length the pendulum's records no longer tell dry friction from a hysteresis, and
/// further hits of the double beam stray from their bands.
const LENGTH: f64 = 1.0;
/// Least decay rate that a prior's width is relative to, over the mean of the curves: a rate that was found small may be small by chance. A judgement.
const LEAST_WIDTH: f64 = 0.3;
/// Part of a variance that is added on the diagonal, so that the matrix stays positive definite in rounding.
const JITTER: f64 = 1e-8;
/// Sizes of the process of ln λ, and of the frequency in parts of its shift, from which records choose the likeliest: from next to a straight line in
/// ln a to far rougher.
const ROUGHNESS: [f64; 6] = [0.01, 0.03, 0.1, 0.3, 1.0, 3.0];
/// Error of averaging: of the decay rate, relative, in units of the damping ratio; of the frequency, relative, in units of the damping ratio squared.
/// Under dry friction the fundamental lags by 4F/(π k a) = 2 ζ, which changes the frequency by 4 ζ² and less; dampers by a power of the velocity stay
/// below.
const SECOND_ORDER: f64 = 2.0;
/// Prior standard deviations of level and slope: of ln λ, and of the frequency relative to itself. Both are wide enough to say nothing.
const DECAY_WIDTH: f64 = 2.0;
const OMEGA_WIDTH: f64 = 0.1;

/// Covariances of the values of curves on a grid: decay rates first, then circular frequencies.
#[derive(Debug, Clone)]
pub(crate) struct Covariances {
    /// Covariance of level and slope.
    pub(crate) line: DMatrix<f64>,
    /// Covariance of decay rates that stray by a factor e.
    pub(crate) decay: DMatrix<f64>,
    /// Covariance of frequencies that stray by their shift.
    pub(crate) omega: DMatrix<f64>,
}

/// The likeliest sizes of the two processes, and the Cholesky factor of the covariance with them.
pub(crate) struct Likeliest {
    pub(crate) decay: f64,
    pub(crate) omega: f64,
    pub(crate) factor: Cholesky<f64, Dyn>,
    /// ln of the likelihood, less its constant.
    pub(crate) log_likelihood: f64,
}

impl Covariances {
    /// Covariances relative to curves `near` those sought; `shift` is the range of the circular frequency, 1/s.
    pub(crate) fn new(grid: &Grid, near: &Rates, shift: f64) -> Self {
        let n = grid.count();
        let middle = grid.middle().ln();
        let width = OMEGA_WIDTH * near.omega.iter().sum::<f64>() / n as f64;
        let least = LEAST_WIDTH * near.decay.iter().sum::<f64>() / n as f64;
        let wide = |i: usize| near.decay[i].max(least);
        let zeros = || DMatrix::zeros(2 * n, 2 * n);
        let (mut line, mut decay, mut omega) = (zeros(), zeros(), zeros());
        for i in 0..n {
            for j in 0..n {
                let (u, v) = (grid.log(i), grid.log(j));
                let straight = 1.0 + (u - middle) * (v - middle);
                let jitter = if i == j { JITTER } else { 0.0 };
                let rough = (-(u - v).abs() / LENGTH).exp() + jitter;
                let product = wide(i) * wide(j);
                line[(i, j)] = product * DECAY_WIDTH.powi(2) * straight;
                line[(n + i, n + j)] = width * width * straight;
                decay[(i, j)] = product * rough;
                omega[(n + i, n + j)] = shift * shift * rough;
            }
        }
        Self { line, decay, omega }
    }

    /// Covariance of what averaging itself leaves out, which is of first order in the damping; relative to curves `near` those sought.
    pub(crate) fn of_averaging(&self, near: &Rates, shift: f64) -> DMatrix<f64> {
        let n = near.decay.len();
        let ratio = |i: usize| near.decay[i] / near.omega[i];
        DMatrix::from_fn(2 * n, 2 * n, |i, j| {
            let (a, b) = (i % n, j % n);
            let decay = SECOND_ORDER.powi(2) * ratio(a) * ratio(b) * self.decay[(i, j)];
            let bend = |i: usize| SECOND_ORDER * ratio(i).powi(2) * near.omega[i] / shift;
            decay + bend(a) * bend(b) * self.omega[(i, j)]
        })
    }

    pub(crate) fn each(&self, map: impl Fn(&DMatrix<f64>) -> DMatrix<f64>) -> Self {
        Self { line: map(&self.line), decay: map(&self.decay), omega: map(&self.omega) }
    }

    /// The sum of the covariances, with the sizes of the two processes.
    pub(crate) fn whole(&self, decay: f64, omega: f64) -> DMatrix<f64> {
        &self.line + &self.decay * (decay * decay) + &self.omega * (omega * omega)
    }

    /// The sizes that make `observed` likeliest, whose covariance is this one plus `noise` on the diagonal.
    pub(crate) fn likeliest(&self, observed: &DVector<f64>, noise: f64) -> Option<Likeliest> {
        let mut best: Option<Likeliest> = None;
        for decay in ROUGHNESS {
            for omega in ROUGHNESS {
                let mut whole = self.whole(decay, omega);
                (0..observed.len()).for_each(|i| whole[(i, i)] += noise);
                let factor = whole.cholesky()?;
                let logs: f64 = factor.l_dirty().diagonal().iter().map(|d| d.abs().ln()).sum();
                let log_likelihood = -0.5 * observed.dot(&factor.solve(observed)) - logs;
                if best.as_ref().is_none_or(|b| log_likelihood > b.log_likelihood) {
                    best = Some(Likeliest { decay, omega, factor, log_likelihood });
                }
            }
        }
        best
    }
}
