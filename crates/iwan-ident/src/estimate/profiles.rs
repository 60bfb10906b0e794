//! Intervals of single unknowns by profile likelihood.

use iwan_machine::threads::in_parallel;
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
struct Landscape<'a, M: Model + ?Sized> {
    model: &'a M,
    minimum: &'a [f64],
    /// Derivatives there, with respect to all unknowns.
    slopes: Option<DMatrix<f64>>,
}

/// What evaluations of one walk hand on.
#[derive(Default)]
struct Buffers {
    residuals: Vec<f64>,
    /// Derivatives with respect to the unknowns that follow, at the last point of the walk.
    slopes: Option<DMatrix<f64>>,
}

impl<M: Model + ?Sized> Ground for Landscape<'_, M> {
    type Work = Buffers;

    fn bounds(&self) -> Vec<(f64, f64)> {
        self.model.bounds().to_vec()
    }

    fn cost(&self, x: &[f64], work: &mut Buffers) -> Option<f64> {
        work.residuals.resize(self.model.count(), 0.0);
        let known = self.model.evaluate(x, &mut work.residuals, None);
        Some(work.residuals.iter().map(|r| r * r).sum::<f64>()).filter(|cost| known && cost.is_finite())
    }

    fn minimise(&self, x: &[f64], free: Vec<usize>, work: &mut Buffers) -> Option<Minimum> {
        search(self.model, &free, ALONG).run_along(&mut Squares(self.model), x, &mut work.slopes)
    }

    /// A walk begins with these, its own unknown last: those that follow find them again.
    fn jacobian(&self, x: &[f64], free: Vec<usize>, work: &mut Buffers) -> Option<DMatrix<f64>> {
        let known = self.slopes.as_ref().filter(|_| x == self.minimum).map(|all| all.select_columns(&free));
        let all = known.or_else(|| Squares(self.model).derivatives_at(x, &free))?;
        work.slopes = Some(all.columns(0, free.len() - 1).into_owned());
        Some(all)
    }

    fn is_at_edge(&self, _: &[f64]) -> bool {
        false
    }
}

/// The intervals of the unknowns `wanted` about a minimum, all others that are free following, walked on so many threads. An unknown
/// that is not free is one that the measurements hardly feel: what its walk gains in the last digits is passed over.
///
/// # Errors
/// A better minimum that was met on the way: begin anew from there.
pub fn intervals<M: Model + ?Sized>(
    model: &M,
    about: About<'_>,
    wanted: &[usize],
    threads: usize,
) -> Result<Vec<Interval>, Found> {
    let (found, free) = (about.found, about.free);
    let all: Vec<usize> = (0..found.x.len()).collect();
    let slopes = Squares(model).derivatives_at(&found.x, &all);
    let ground = Landscape { model, minimum: &found.x, slopes };
    let of = |j: &usize| {
        let settled = about.settled || !free.contains(j);
        interval(&ground, About { settled, ..about }, *j)
    };
    in_parallel(wanted, threads, &of).into_iter().collect()
}

fn interval<M: Model + ?Sized>(
    ground: &Landscape<'_, M>,
    about: About<'_>,
    of: usize,
) -> Result<Interval, Found> {
    let About { found, free, variance, settled } = about;
    let freedom = (ground.model.count() as f64 - free.len() as f64).max(1.0);
    let minimum = Minimum::from(found);
    let mut scale = Scale::about(found.cost, variance.max(f64::MIN_POSITIVE), freedom);
    if settled {
        scale.better = f64::NEG_INFINITY;
    }
    let others: Vec<usize> = free.iter().copied().filter(|j| *j != of).collect();
    let mut ends = [None, None];
    for (end, direction) in ends.iter_mut().zip([-1.0, 1.0]) {
        let mut walk = Walk::new(ground, of, others.clone(), &minimum, &scale);
        *end = match walk.go(direction).map_err(Found::from)? {
            End::Open => None,
            End::Closed(at) => Some(at),
        };
    }
    Ok(Interval { low: ends[0], high: ends[1] })
}
