//! Intervals of single unknowns by profile likelihood.

use iwan_machine::threads::in_parallel;
use nalgebra::DMatrix;

use super::minimum::{Found, search};
use super::model::{Model, Squares};
use crate::profile::{End, Ground, Scale, Walk};
use crate::search::Minimum;

/// Largest number of steps of a search along a profile. A search that is not through by then leaves the profile a little too high, and the interval too narrow.
const ALONG: usize = 60;

/// A 95 % interval; an end that is `None` is open.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Interval {
    /// Lower end.
    pub low: Option<f64>,
    /// Upper end.
    pub high: Option<f64>,
}

impl Interval {
    /// From lower and upper ends in turn; the first failure among them where there is one.
    pub(crate) fn of_ends<E>(ends: Vec<Result<Option<f64>, E>>) -> Result<Vec<Self>, E> {
        let ends = ends.into_iter().collect::<Result<Vec<_>, E>>()?;
        Ok(ends.chunks_exact(2).map(|pair| Self { low: pair[0], high: pair[1] }).collect())
    }
}

/// The minimum about which intervals are taken.
#[derive(Debug, Clone, Copy)]
pub struct About<'a> {
    /// The minimum.
    pub found: &'a Found,
    /// Unknowns that follow when one of them is held.
    pub free: &'a [usize],
    /// Variance of the residuals in their unit.
    pub variance: f64,
    /// What happens when a walk meets a better point: where this is true it is passed over, else the walk ends there.
    pub settled: bool,
}

/// A model as seen by the walks along one unknown.
struct Landscape<'a, M: Model + ?Sized> {
    model: &'a M,
    minimum: &'a [f64],
    /// Derivatives at the minimum, with respect to all unknowns.
    slopes: Option<&'a DMatrix<f64>>,
}

/// What one evaluation of a walk hands on to the next.
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

    fn minimise(&self, x: &[f64], free: Vec<usize>, tolerance: f64, work: &mut Buffers) -> Option<Minimum> {
        search(self.model, &free, (ALONG, tolerance)).run_along(&mut Squares(self.model), x, &mut work.slopes)
    }

    /// Derivatives with which a walk begins, its own unknown last; those of the unknowns that follow are kept for the searches of the walk.
    fn jacobian(&self, x: &[f64], free: Vec<usize>, work: &mut Buffers) -> Option<DMatrix<f64>> {
        let known = self.slopes.filter(|_| x == self.minimum).map(|all| all.select_columns(&free));
        let all = known.or_else(|| Squares(self.model).derivatives_at(x, &free))?;
        work.slopes = Some(all.columns(0, free.len() - 1).into_owned());
        Some(all)
    }

    fn is_at_edge(&self, _: &[f64]) -> bool {
        false
    }
}

/// Walks along single unknowns about a minimum; all others that are free follow. A better point met by the walk of an unknown that is not free is passed over: the measurements
/// hardly feel such an unknown, and the gain is in the last digits.
pub(crate) struct Profiles<'a, M: Model + ?Sized> {
    model: &'a M,
    about: About<'a>,
    minimum: Minimum,
    slopes: Option<DMatrix<f64>>,
}

impl<'a, M: Model + ?Sized> Profiles<'a, M> {
    pub(crate) fn about(model: &'a M, about: About<'a>) -> Self {
        let all: Vec<usize> = (0..about.found.x.len()).collect();
        let slopes = Squares(model).derivatives_at(&about.found.x, &all);
        Self { model, about, minimum: Minimum::from(about.found), slopes }
    }

    /// The end of the interval of the unknown `of` in a direction, with its variance multiplied by `wider`; none: open.
    ///
    /// # Errors
    /// A better minimum that was met on the way.
    pub(crate) fn end(&self, of: usize, direction: f64, wider: f64) -> Result<Option<f64>, Found> {
        let About { found, free, variance, settled } = self.about;
        let freedom = (self.model.count() as f64 - free.len() as f64).max(1.0);
        let mut scale = Scale::about(found.cost, (wider * variance).max(f64::MIN_POSITIVE), freedom);
        if settled || !free.contains(&of) {
            scale.better = f64::NEG_INFINITY;
        }
        let ground = Landscape { model: self.model, minimum: &found.x, slopes: self.slopes.as_ref() };
        let others: Vec<usize> = free.iter().copied().filter(|j| *j != of).collect();
        match Walk::new(&ground, of, others, &self.minimum, &scale).go(direction).map_err(Found::from)? {
            End::Open => Ok(None),
            End::Closed(at) => Ok(Some(at)),
        }
    }
}

/// The intervals of the unknowns `wanted` about a minimum, walked on `threads` threads; all others that are free follow. A better point met by the walk of an unknown
/// that is not free is passed over: the measurements hardly feel such an unknown, and the gain is in the last digits.
///
/// # Errors
/// A better minimum that was met on the way: the search is to begin anew from there.
pub fn intervals<M: Model + ?Sized>(
    model: &M,
    about: About<'_>,
    wanted: &[usize],
    threads: usize,
) -> Result<Vec<Interval>, Found> {
    let profiles = Profiles::about(model, about);
    let walks: Vec<(usize, f64)> = wanted.iter().flat_map(|j| [(*j, -1.0), (*j, 1.0)]).collect();
    let ends = in_parallel(&walks, threads, &|(j, direction)| profiles.end(*j, *direction, 1.0));
    Interval::of_ends(ends)
}
