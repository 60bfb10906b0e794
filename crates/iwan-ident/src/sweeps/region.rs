//! The points that a shaker's test accepts: for each knee (φ_max) the best values of all other unknowns.

use nalgebra::DMatrix;

use super::task::Task;
use crate::likelihood::Buffers;
use crate::profile::{Charted, Ground, Region, Scale, is_all_joint};
use crate::search::{Chart, Minimum, Search, TOLERANCE as FINE};

/// Relative reduction of the sum of squares at which a search on the way along the knees ends: a hundredth of a residual's variance among a thousand.
const TOLERANCE: f64 = 1e-6;
/// Largest number of iterations of such a search, which begins at its neighbour's values.
const ITERATIONS: usize = 40;
/// Number of closely spaced knees on either side of the best one.
const CLOSE: u32 = 12;
/// Their spacing, as a fraction of the knee's standard deviation.
const SHARE: f64 = 0.25;
/// Largest spacing, in logarithms, taken where the curvature says nothing.
const LONGEST: f64 = 0.05;
/// Next to the best knee a search does not begin from a neighbour whose deviance is beyond this many limits: valleys (local minima) farther up are not looked for there.
const FAR: f64 = 4.0;

impl Ground for Task<'_> {
    type Work = Buffers;

    fn bounds(&self) -> Vec<(f64, f64)> {
        Task::bounds(self)
    }

    fn cost(&self, x: &[f64], work: &mut Buffers) -> Option<f64> {
        let mut out = vec![0.0; self.count()];
        let known = self.residuals(x, &mut out, work);
        let cost: f64 = out.iter().map(|r| r * r).sum();
        (known && cost.is_finite()).then_some(cost)
    }

    fn minimise(&self, x: &[f64], free: Vec<usize>, tolerance: f64, _: &mut Buffers) -> Option<Minimum> {
        Task::minimise(self, x, free, tolerance.min(TOLERANCE), ITERATIONS)
    }

    fn jacobian(&self, x: &[f64], free: Vec<usize>, work: &mut Buffers) -> Option<DMatrix<f64>> {
        let bounds = Task::bounds(self);
        let search = Search::new(self.count(), free, bounds, (0, FINE));
        let mut residuals = |x: &[f64], out: &mut [f64]| self.residuals(x, out, work);
        let mut r = vec![0.0; self.count()];
        residuals(x, &mut r);
        search.jacobian(&mut residuals, x, &r)
    }

    fn is_at_edge(&self, x: &[f64]) -> bool {
        is_all_joint(&self.chart.parameters(x))
    }
}

impl Charted for Task<'_> {
    fn chart(&self) -> &Chart {
        &self.chart
    }

    fn smooth_at(&self, x: &[f64]) -> Vec<usize> {
        self.smooth(x)
    }
}

/// All points that the data accept: from the minimum along all knees, or the minimum alone where the knee is not sought.
///
/// # Errors
/// A better minimum.
pub(super) fn region(task: &Task<'_>, minimum: &Minimum, scale: &Scale) -> Result<Region, Minimum> {
    let mut work = Buffers::default();
    let mut found = vec![minimum.clone()];
    let knee = task.knee().map(|knee| (knee, task.knee_range()));
    if let Some((knee, range)) = knee {
        found.extend(along(task, minimum, scale, knee, range, &mut work));
    }
    Region::of(task, found, knee, scale)
}

/// The best values of all other unknowns at knees near the minimum's, closely spaced, and at knees through the whole range.
fn along(
    task: &Task<'_>,
    minimum: &Minimum,
    scale: &Scale,
    knee: usize,
    [low, high]: [f64; 2],
    work: &mut Buffers,
) -> Vec<Minimum> {
    let start = minimum.x[knee];
    let step = step(task, minimum, knee, work);
    let close = |direction: f64| (1..=CLOSE).map(move |i| start + direction * step * f64::from(i));
    let coarse = task.knees();
    let mut found: Vec<Minimum> = Vec::new();
    for direction in [-1.0, 1.0] {
        let beyond = coarse.iter().copied().filter(|k| (k - start) * direction > step * f64::from(CLOSE));
        let mut knees: Vec<f64> =
            close(direction).chain(beyond).filter(|k| (low..=high).contains(k)).collect();
        knees.sort_by(|a, b| (a - start).abs().total_cmp(&(b - start).abs()));
        let mut near = minimum.clone();
        for at in knees {
            let mut x = near.x.clone();
            x[knee] = at;
            let free = task.smooth(&x);
            let Some(next) = Task::minimise(task, &x, free, TOLERANCE, ITERATIONS) else { continue };
            if (at - start).abs() > step * f64::from(CLOSE) || scale.rise(&next) < FAR * scale.limit {
                near = next.clone();
            }
            found.push(next);
        }
    }
    // The best of them, where it is better than the minimum, is searched once more with its knee free.
    let best = found.iter().min_by(|a, b| a.cost.total_cmp(&b.cost)).filter(|m| m.cost < minimum.cost);
    let polished = best.and_then(|m| Task::minimise(task, &m.x, task.free(), TOLERANCE, ITERATIONS));
    found.extend(polished);
    found
}

/// Spacing of the close knees: a fraction of the knee's standard deviation by curvature, all other unknowns following.
fn step(task: &Task<'_>, minimum: &Minimum, knee: usize, work: &mut Buffers) -> f64 {
    let mut free = task.smooth(&minimum.x);
    free.push(knee);
    let last = free.len() - 1;
    let left = task.jacobian(&minimum.x, free, work).map_or(0.0, |j| j.qr().r()[(last, last)].abs());
    if left > 0.0 { (SHARE / left).min(LONGEST) } else { LONGEST }
}
