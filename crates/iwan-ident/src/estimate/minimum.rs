//! The least sum of squares of a model, from several starts.

use std::ops::Range;

use super::model::{Model, Squares};
use crate::error::{Error, check};
use crate::search::{LARGE_GROWTH, Minimum, Search, TOLERANCE};

/// Largest number of steps of a search; ten to fifty are usual. A search that has not settled by then is taken where it stands, and `converged` says so.
const ITERATIONS: usize = 200;
/// Number of steps and relative reduction of the first, coarse search from each start: enough to tell valleys (local minima of the sum of squares) apart.
const COARSE: (usize, f64) = (25, 1e-3);
/// Number of coarse searches that are carried on, the best first: the best may lie in a crease that the second leaves.
const CARRIED_ON: usize = 2;

/// Where a search ended.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// The unknowns.
    pub x: Vec<f64>,
    /// Sum of squares of the residuals.
    pub cost: f64,
    /// Whether the search reached a minimum.
    pub converged: bool,
}

impl From<Minimum> for Found {
    fn from(Minimum { x, cost, converged }: Minimum) -> Self {
        Self { x, cost, converged }
    }
}

impl From<&Found> for Minimum {
    fn from(Found { x, cost, converged }: &Found) -> Self {
        Self { x: x.clone(), cost: *cost, converged: *converged }
    }
}

/// The search over the unknowns in `free`, with a largest number of iterations and a relative reduction at which it ends.
pub(super) fn search<M: Model + ?Sized>(model: &M, free: &[usize], effort: (usize, f64)) -> Search {
    let bounds = model.bounds().to_vec();
    // Residuals are in standard deviations, so a sum of squares of a millionth counts as zero.
    let (count, free) = (model.count(), free.to_vec());
    Search { growth: LARGE_GROWTH, floor: 1e-6, ..Search::new(count, free, bounds, effort) }
}

/// The least sum of squares over the unknowns in `free`; the others keep the values of the start.
///
/// # Errors
/// [`Error::OutOfRange`] without a start; [`Error::TooShort`] with fewer residuals than unknowns; [`Error::Refused`] when no start has
/// residuals.
///
/// ```
/// use iwan_ident::estimate::{Model, least};
/// /// y = exp(a) t, at t = 1, 2, 3.
/// struct Line([f64; 3]);
/// impl Model for Line {
///     fn bounds(&self) -> &[(f64, f64)] { &[(-9.0, 9.0)] }
///     fn count(&self) -> usize { 3 }
///     fn evaluate(&self, x: &[f64], r: &mut [f64], mut slopes: Option<&mut [Vec<f64>]>) -> bool {
///         for i in 0..3 {
///             let y = x[0].exp() * (i + 1) as f64;
///             r[i] = y - self.0[i];
///             if let Some(slopes) = &mut slopes { slopes[0][i] = y; }
///         }
///         true
///     }
/// }
/// let found = least(&Line([2.0, 4.0, 6.0]), &[vec![0.0]], &[0])?;
/// assert!((found.x[0] - 2.0_f64.ln()).abs() < 1e-9);
/// # Ok::<(), iwan_ident::Error>(())
/// ```
pub fn least<M: Model + ?Sized>(model: &M, starts: &[Vec<f64>], free: &[usize]) -> Result<Found, Error> {
    check("starts", starts.len() as f64, !starts.is_empty(), "at least one", "give start values")?;
    if model.count() < free.len() {
        let remedy = "measure more, or seek fewer unknowns";
        let (found, needed) = (model.count(), free.len());
        return Err(Error::TooShort { what: "residuals", found, needed, remedy });
    }
    let run = |start: &[f64], effort| search(model, free, effort).run(&mut Squares(model), start);
    let mut coarse: Vec<Minimum> = match starts {
        [one] => vec![Minimum { x: one.clone(), cost: f64::INFINITY, converged: false }],
        all => all.iter().filter_map(|start| run(start, COARSE)).collect(),
    };
    coarse.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let fine = coarse.iter().take(CARRIED_ON).filter_map(|start| run(&start.x, (ITERATIONS, TOLERANCE)));
    let best = fine.min_by(|a, b| a.cost.total_cmp(&b.cost));
    best.map(Found::from).ok_or_else(|| Error::Refused {
        finding: "the start values have no model".into(),
        remedy: "start nearer to the solution, or leave out the largest amplitudes",
    })
}

/// The least sum of squares near one start; `effort` is a largest number of iterations and a relative reduction. None where the start has no residuals.
#[must_use]
pub fn near<M: Model + ?Sized>(
    model: &M,
    start: &[f64],
    free: &[usize],
    effort: (usize, f64),
) -> Option<Found> {
    search(model, free, effort).run(&mut Squares(model), start).map(Found::from)
}

/// Standard deviations of several series of residuals, found from the residuals themselves.
#[derive(Debug, Clone, PartialEq)]
pub struct Weights {
    /// Root mean square of each series, less the freedom that the fitted unknowns took from it.
    pub deviations: Vec<f64>,
    /// Factor (>= 1) by which the correlation of neighbouring residuals widens variances.
    pub inflation: f64,
}

/// A correlation of neighbours of up to this many standard deviations of that of white noise is taken for chance, and widens nothing.
const BY_CHANCE: f64 = 2.0;
/// Correlation from which on variances are widened no more; the factor is then about nineteen. Residuals with more belong to a model that does not fit, which
/// the verdict says.
const MOST_CORRELATED: f64 = 0.9;

impl Weights {
    /// From residuals in series that stand one behind the other; `unknowns` were fitted to all of them together.
    #[must_use]
    pub fn of(residuals: &[f64], series: &[Range<usize>], unknowns: usize) -> Self {
        let total: usize = series.iter().map(ExactSizeIterator::len).sum();
        let share = unknowns as f64 / (total as f64).max(1.0);
        let deviation = |range: &Range<usize>| {
            let square: f64 = residuals[range.clone()].iter().map(|r| r * r).sum();
            (square / ((1.0 - share) * range.len() as f64).max(1.0)).sqrt()
        };
        let deviations: Vec<f64> = series.iter().map(deviation).collect();
        let (mut product, mut square, mut pairs) = (0.0, 0.0, 0.0);
        for (range, deviation) in series.iter().zip(&deviations).filter(|(_, d)| **d > 0.0) {
            let part = &residuals[range.clone()];
            product += part.iter().zip(&part[1..]).map(|(a, b)| a * b).sum::<f64>() / (deviation * deviation);
            square += part.iter().map(|r| r * r).sum::<f64>() / (deviation * deviation);
            pairs += part.len() as f64;
        }
        let r = if square > 0.0 { product / square } else { 0.0 };
        let chance = r <= BY_CHANCE / pairs.max(1.0_f64).sqrt();
        let inflation = if chance { 1.0 } else { (1.0 + r) / (1.0 - r.min(MOST_CORRELATED)) };
        Self { deviations, inflation }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alternating_residuals_are_not_correlated_and_slow_ones_are() {
        let alternating: Vec<f64> = (0..100).map(|i| if i % 2 == 0 { 0.3 } else { -0.3 }).collect();
        let weights = Weights::of(&alternating, &[0..50, 50..100], 0);
        assert!((weights.deviations[0] - 0.3).abs() < 1e-12 && weights.inflation == 1.0);
        let slow: Vec<f64> = (0..100).map(|i| (0.05 * f64::from(i)).sin()).collect();
        assert!(Weights::of(&slow, std::slice::from_ref(&(0..100)), 0).inflation > 10.0);
    }
}
