//! One law fitted to the curves: its coordinates, the size of the discrepancy that it needs, and its evidence.

use nalgebra::{DMatrix, DVector};

use super::discrepancy::{Ladder, Whitener};
use super::mode::LawMode;
use super::slow::Information;
use super::terms::{Coordinate, Scales, Term, coordinates};
use crate::search::{Search, TOLERANCE};

/// Most rounds in which coordinates and sizes of the discrepancy are made to agree: the sizes stand on a ladder, so that they settle soon.
const ROUNDS: usize = 4;
/// Most iterations of a search from one of many starts, and of the last search.
const FIRST_STEPS: usize = 30;
const LAST_STEPS: usize = 100;
/// Most iterations of a search with a coordinate held, from a neighbour.
const HELD_STEPS: usize = 40;
/// Precision (inverse variance) that holds a coordinate, in units of its prior: its standard deviation is then a millionth of the prior's.
const HELD: f64 = 1e12;
/// Relative reduction of the sum of squares at which a first search ends.
const FIRST_TOLERANCE: f64 = 1e-4;

/// Logarithm of a law's decay rate over that of the curves up to which their difference counts as it is, in the form in which records tell it.
/// Beyond, where the law misses the curves, the logarithm itself counts: a discrepancy is a factor, and a rate that is too large by a factor is as
/// wrong as one that is too small by it. Differences relative to the curves drew laws to where curves have least damping: a linear mode to 4e-5
/// between curves of 4e-5 and 3e-4.
const AS_TOLD: f64 = 0.2;

/// Least decay rate of a law as a part of that of the curves, so that it has a logarithm.
const LEAST_DECAY: f64 = 1e-6;

/// The relative deviation that counts for a decay rate which is off by the logarithm `away`: exact up to `AS_TOLD`, straight in the logarithm beyond.
fn off(away: f64) -> f64 {
    let inside = away.clamp(-AS_TOLD, AS_TOLD);
    inside.exp_m1() + inside.exp() * (away - inside)
}

/// A law to be fitted, with what it is fitted to.
#[derive(Debug, Clone)]
pub(super) struct Problem<'a> {
    pub(super) terms: &'a [Term],
    pub(super) scales: Scales,
    pub(super) amplitudes: &'a [f64],
    pub(super) information: &'a Information,
    /// Decay rates of the curves at all amplitudes, 1/s; discrepancies are factors on these.
    pub(super) decay: &'a [f64],
    /// Index of each amplitude that the records saw, with ln λ and ω of the smooth curves there.
    pub(super) smooth: &'a [(usize, f64, f64)],
    pub(super) coordinates: Vec<Coordinate>,
}

/// A law with its parameters at some coordinates.
#[derive(Debug, Clone)]
pub(super) struct At {
    pub(super) x: Vec<f64>,
    pub(super) mode: LawMode,
    /// Covariance of the coordinates, with the prior included.
    pub(super) covariance: DMatrix<f64>,
}

/// A fitted law.
#[derive(Debug, Clone)]
pub(super) struct Fitted<'a> {
    pub(super) at: At,
    /// The discrepancy that goes with the law.
    pub(super) whitener: &'a Whitener,
    /// Sum of squares of the residuals, whitened with this discrepancy.
    pub(super) cost: f64,
    /// Twice the negative logarithm of the evidence.
    pub(super) criterion: f64,
}

impl Fitted<'_> {
    /// The fit with the larger evidence of two.
    pub(super) fn or_better(self, other: Option<Self>) -> Self {
        other.filter(|other| other.criterion < self.criterion).unwrap_or(self)
    }
}

/// A law fitted with one coordinate held.
#[derive(Debug, Clone)]
pub(super) struct Held {
    pub(super) fitted: At,
    /// Sum of squares of the whitened residuals.
    pub(super) cost: f64,
}

/// Residuals and their derivatives with respect to the coordinates at a point.
struct Local {
    residuals: DVector<f64>,
    jacobian: DMatrix<f64>,
}

impl<'a> Problem<'a> {
    pub(super) fn new(
        terms: &'a [Term],
        scales: Scales,
        amplitudes: &'a [f64],
        information: &'a Information,
        decay: &'a [f64],
        smooth: &'a [(usize, f64, f64)],
    ) -> Self {
        Self { terms, scales, amplitudes, information, decay, smooth, coordinates: coordinates(terms) }
    }

    /// Lowest and highest knee worth trying, as coordinates: from below the smallest amplitude to far above the largest, where no knee is seen.
    pub(super) fn knees(&self) -> (f64, f64) {
        const BELOW: f64 = -0.5;
        const ABOVE: f64 = 3.0;
        let log = |a: Option<&f64>| a.map_or(0.0, |a| (a / self.scales.amplitude).ln());
        (log(self.amplitudes.first()) + BELOW, log(self.amplitudes.last()) + ABOVE)
    }

    /// What the law misses of the information; none where the coordinates are no model.
    pub(super) fn residuals(&self, x: &[f64]) -> Option<DVector<f64>> {
        let mode = self.scales.mode(self.terms, x)?;
        let rates = mode.rates(self.amplitudes).ok()?;
        let n = rates.len();
        // A law that drives the mode at some amplitude is as far off as one that hardly damps it.
        let least = |near: f64| LEAST_DECAY * near;
        let decay = rates
            .iter()
            .zip(self.decay)
            .map(|(r, near)| near * (1.0 + off((r.decay.max(least(*near)) / near).ln())));
        let curves = DVector::from_iterator(2 * n, decay.chain(rates.iter().map(|r| r.omega)));
        Some(&self.information.target - &self.information.factor * curves)
    }

    fn search(&self, iterations: usize, tolerance: f64) -> Search {
        self.search_but(None, iterations, tolerance)
    }

    fn search_but(&self, held: Option<usize>, iterations: usize, tolerance: f64) -> Search {
        let free = (0..self.coordinates.len()).filter(|j| Some(*j) != held).collect();
        let bounds = self.coordinates.iter().map(|c| c.bounds).collect();
        let count = self.information.target.len();
        Search { floor: 1.0, ..Search::new(count, free, bounds, (iterations, tolerance)) }
    }

    /// The coordinates next to `x` that make other residuals, of which there are as many, least in squares.
    pub(super) fn likeliest_by(
        &self,
        mut residuals: impl FnMut(&[f64], &mut [f64]) -> bool,
        x: &[f64],
    ) -> Option<Vec<f64>> {
        self.search(HELD_STEPS, FIRST_TOLERANCE).run(&mut residuals, x).map(|found| found.x)
    }

    fn whitened<'b>(&'b self, whitener: &'b Whitener) -> impl FnMut(&[f64], &mut [f64]) -> bool + 'b {
        move |x, out| {
            let Some(residuals) = self.residuals(x) else { return false };
            out.copy_from_slice(whitener.vector(&residuals).as_slice());
            true
        }
    }

    /// All combinations of the coordinates' start values.
    fn starts(&self) -> Vec<Vec<f64>> {
        let mut all = vec![vec![]];
        for coordinate in &self.coordinates {
            let longer = |x: &Vec<f64>| {
                let x = x.clone();
                coordinate.starts.iter().map(move |s| x.iter().copied().chain([*s]).collect::<Vec<f64>>())
            };
            all = all.iter().flat_map(longer).collect();
        }
        all
    }

    /// The coordinates whose curves lie nearest to the smooth ones, with all amplitudes weighted alike. A discrepancy can follow every smooth curve:
    /// a search with a discrepancy, from far away, would fit what is not smooth and leave the rest to the discrepancy.
    fn nearest(&self, more: &[Vec<f64>]) -> Option<Vec<f64>> {
        let search = Search { count: 2 * self.smooth.len(), ..self.search(FIRST_STEPS, FIRST_TOLERANCE) };
        let mut residuals = |x: &[f64], out: &mut [f64]| {
            let rates = self.scales.mode(self.terms, x).and_then(|mode| mode.rates(self.amplitudes).ok());
            let Some(rates) = rates else { return false };
            for (out, &(i, log_decay, omega)) in out.chunks_exact_mut(2).zip(self.smooth) {
                out[0] = rates[i].decay.max(f64::MIN_POSITIVE).ln() - log_decay;
                out[1] = (rates[i].omega - omega) / self.scales.shift;
            }
            true
        };
        let starts = self.starts();
        let all = starts.iter().chain(more).filter_map(|start| search.run(&mut residuals, start));
        all.min_by(|a, b| a.cost.total_cmp(&b.cost)).map(|best| best.x)
    }

    /// The law with the discrepancy that makes it likeliest, and its evidence; sought from the coordinates nearest to the smooth curves and from
    /// those in `more`.
    pub(super) fn fit<'l>(&self, ladder: &'l Ladder, more: &[Vec<f64>]) -> Option<Fitted<'l>> {
        let nearest = self.nearest(more);
        let all = nearest.iter().chain(more).filter_map(|x| self.fit_from(ladder, x));
        all.min_by(|a, b| a.criterion.total_cmp(&b.criterion))
    }

    /// The law with the discrepancy that makes it likeliest, sought next to the coordinates `x` only.
    pub(super) fn fit_from<'l>(&self, ladder: &'l Ladder, x: &[f64]) -> Option<Fitted<'l>> {
        let mut x = x.to_vec();
        let last = self.search(LAST_STEPS, TOLERANCE);
        let mut whitener = self.size(ladder, &x)?;
        for _ in 0..ROUNDS {
            x = last.run(&mut self.whitened(whitener), &x)?.x;
            let likelier = self.size(ladder, &x)?;
            if std::ptr::eq(likelier, whitener) {
                break;
            }
            whitener = likelier;
        }
        let local = self.local(&x)?;
        let (whitener, criterion) = ladder.typical(|rung| self.criterion(rung, &local));
        let covariance = self.precision(whitener, &local).cholesky()?.inverse();
        Some(Fitted {
            criterion,
            cost: whitener.vector(&local.residuals).norm_squared(),
            at: At {
                mode: self.scales.mode(self.terms, &x)?,
                covariance: self.in_coordinates(&covariance),
                x,
            },
            whitener,
        })
    }

    fn size<'l>(&self, ladder: &'l Ladder, x: &[f64]) -> Option<&'l Whitener> {
        let local = self.local(x)?;
        Some(ladder.least(|rung| self.criterion(rung, &local)))
    }

    /// The likeliest coordinates next to `x` with coordinate `held` kept, and the sum of squares there, for the discrepancy of `whitener`.
    pub(super) fn holding(&self, whitener: &Whitener, held: usize, x: &[f64]) -> Option<Held> {
        let found =
            self.search_but(Some(held), HELD_STEPS, FIRST_TOLERANCE).run(&mut self.whitened(whitener), x)?;
        let local = self.local(&found.x)?;
        let mut precision = self.precision(whitener, &local);
        // A coordinate that is held has no variance.
        precision[(held, held)] += HELD;
        let covariance = self.in_coordinates(&precision.cholesky()?.inverse());
        Some(Held {
            fitted: At { mode: self.scales.mode(self.terms, &found.x)?, x: found.x, covariance },
            cost: found.cost,
        })
    }

    fn local(&self, x: &[f64]) -> Option<Local> {
        let residuals = self.residuals(x)?;
        let mut plain = |x: &[f64], out: &mut [f64]| {
            self.residuals(x).is_some_and(|r| {
                out.copy_from_slice(r.as_slice());
                true
            })
        };
        let jacobian = self.search(1, TOLERANCE).jacobian(&mut plain, x, residuals.as_slice())?;
        Some(Local { residuals, jacobian })
    }

    /// Derivatives of the whitened residuals with respect to coordinates in units of their priors' standard deviations.
    fn scaled(&self, whitener: &Whitener, local: &Local) -> DMatrix<f64> {
        let mut jacobian = whitener.matrix(&local.jacobian);
        for (mut column, c) in jacobian.column_iter_mut().zip(&self.coordinates) {
            column *= c.width;
        }
        jacobian
    }

    /// Twice the negative logarithm of the evidence by Laplace's method: the coordinates are integrated out, with the point itself as the middle of
    /// the prior. Coordinates that the records tell then cost ln of the prior's width over that of the posterior, and coordinates that they do not
    /// tell cost nothing.
    fn criterion(&self, whitener: &Whitener, local: &Local) -> f64 {
        let jacobian = self.scaled(whitener, local);
        let residuals = whitener.vector(&local.residuals);
        let p = self.coordinates.len();
        let Some(inner) = (jacobian.transpose() * &jacobian + DMatrix::identity(p, p)).cholesky() else {
            return f64::INFINITY;
        };
        let gradient = jacobian.transpose() * &residuals;
        let logs: f64 = inner.l_dirty().diagonal().iter().map(|d| d.abs().ln()).sum();
        whitener.log_determinant + residuals.norm_squared() - gradient.dot(&inner.solve(&gradient))
            + 2.0 * logs
    }

    /// Precision (inverse covariance) of the coordinates in units of their priors, with the priors included.
    fn precision(&self, whitener: &Whitener, local: &Local) -> DMatrix<f64> {
        let jacobian = self.scaled(whitener, local);
        let p = self.coordinates.len();
        jacobian.transpose() * &jacobian + DMatrix::identity(p, p)
    }

    fn in_coordinates(&self, covariance: &DMatrix<f64>) -> DMatrix<f64> {
        let width = |i: usize| self.coordinates[i].width;
        DMatrix::from_fn(covariance.nrows(), covariance.ncols(), |i, j| {
            covariance[(i, j)] * width(i) * width(j)
        })
    }
}
