//! Intervals of single unknowns by profile likelihood.

use nalgebra::DMatrix;

use super::minimum::{Found, search};
use super::model::{Model, Squares};
use crate::profile::{End, Ground, Scale, Walk};
use crate::search::Minimum;

/// Steps and relative reduction of a search along a profile, as in the profiles of a mode.
const ALONG: (usize, f64) = (60, 1e-5);

/// A 95 % interval; none: open.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Interval {
    /// Lower end.
    pub low: Option<f64>,
    /// Upper end.
    pub high: Option<f64>,
}

/// What an interval is taken about.
#[derive(Debug, Clone, Copy)]
pub struct About<'a> {
    /// The minimum.
    pub found: &'a Found,
    /// Unknowns that follow.
    pub free: &'a [usize],
    /// Variance of the residuals in their unit.
    pub variance: f64,
    /// Whether a better point, should a walk meet one, is passed over: else the walk ends there.
    pub settled: bool,
}

/// A model as walks see it.
struct Landscape<'a, M: Model + ?Sized>(&'a M);

impl<M: Model + ?Sized> Ground for Landscape<'_, M> {
    type Work = Vec<f64>;

    fn bounds(&self) -> Vec<(f64, f64)> {
        self.0.bounds().to_vec()
    }

    fn cost(&self, x: &[f64], work: &mut Vec<f64>) -> Option<f64> {
        work.resize(self.0.count(), 0.0);
        let known = self.0.evaluate(x, work, None);
        Some(work.iter().map(|r| r * r).sum::<f64>()).filter(|cost| known && cost.is_finite())
    }

    fn minimise(&self, x: &[f64], free: Vec<usize>, _: &mut Vec<f64>) -> Option<Minimum> {
        search(self.0, &free, ALONG).run(&mut Squares(self.0), x)
    }

    fn jacobian(&self, x: &[f64], free: Vec<usize>, _: &mut Vec<f64>) -> Option<DMatrix<f64>> {
        Squares(self.0).derivatives_at(x, &free)
    }

    fn is_at_edge(&self, _: &[f64]) -> bool {
        false
    }
}

/// The interval of the unknown `of` about a minimum, all others that are free following.
///
/// # Errors
/// A better minimum that was met on the way: begin anew from there.
pub fn interval<M: Model + ?Sized>(model: &M, about: About<'_>, of: usize) -> Result<Interval, Found> {
    let About { found, free, variance, settled } = about;
    let freedom = (model.count() as f64 - free.len() as f64).max(1.0);
    let (minimum, ground) = (Minimum::from(found), Landscape(model));
    let mut scale = Scale::about(found.cost, variance.max(f64::MIN_POSITIVE), freedom);
    if settled {
        scale.better = f64::NEG_INFINITY;
    }
    let others: Vec<usize> = free.iter().copied().filter(|j| *j != of).collect();
    let mut ends = [None, None];
    for (end, direction) in ends.iter_mut().zip([-1.0, 1.0]) {
        let mut walk = Walk::new(&ground, of, others.clone(), &minimum, &scale);
        *end = match walk.go(direction).map_err(Found::from)? {
            End::Open => None,
            End::Closed(at) => Some(at),
        };
    }
    Ok(Interval { low: ends[0], high: ends[1] })
}
