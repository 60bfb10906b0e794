//! The search in windows that grow from the start of the records: a mode whose frequency is a little off runs out of phase within a long record, and there every start ends in a
//! local minimum of its own.

use std::sync::atomic::Ordering;

use iwan_machine::threads::in_parallel;

use super::model::CoupledModel;
use crate::error::Error;
use crate::estimate::{Found, Model, Weights, near};

/// For each window: share of the records, (iterations, relative reduction) of the search from each point, and number of points kept.
const WINDOWS: [(f64, (usize, f64), usize); 4] =
    [(0.1, (12, 1e-3), 4), (0.25, (12, 1e-3), 3), (0.5, (12, 1e-3), 2), (1.0, (40, 1e-5), 1)];
/// Iterations and relative reduction of the last search: a millionth of the sum of squares is a ten-thousandth of a 95 % interval for the
/// records at hand.
pub(super) const LAST: (usize, f64) = (60, 1e-6);

/// Number of starts that are searched from: those that leave the smallest sum of squares. Twenty starts next to the modes' own curves, not first compared with the records,
/// led two modes that share a joint to a minimum that leaves 8 % instead of 0.04 %; the number itself was not varied.
const SEARCHED: usize = 20;
/// Largest number of further searches of [`LAST`] where the one in the last window ended before its minimum; not varied. A model that is not at its
/// minimum after all of them, or was not gone on with, says so (`converged`).
const FURTHER: usize = 4;
/// Sum of squares over that of the best model up to which a search is gone on with. A search through all windows leaves per cents; a model that leaves ten times as much as another
/// one is not the better of the two. On the paper's beam modes with joints of their own leave 700 times as much as a joint that they share.
const NEAR_BEST: f64 = 10.0;
/// Residuals are noise where the correlation of neighbours widens variances by less than this. Hann windows that overlap by half share a sixth of their
/// variance, which makes 1.4 for white noise.
const WHITE: f64 = 2.0;

/// The unknowns with the least sum of squares, sought in growing windows; the last window is the whole of the records, and its search may end before the
/// minimum ([`through`]).
pub(super) fn grown(model: &mut CoupledModel<'_>, starts: &[Vec<f64>]) -> Result<Found, Error> {
    let free: Vec<usize> = (0..model.form.unknowns.len()).collect();
    let mut kept = nearest(model, starts);
    let mut found: Vec<Found> = Vec::new();
    for (share, effort, keep) in WINDOWS {
        model.take(share);
        found = kept.iter().filter_map(|x| near(model, x, &free, effort)).collect();
        if model.stopped.load(Ordering::Relaxed) {
            return Err(Error::Stopped);
        }
        found.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        found.truncate(keep);
        // In a window too short to have as many residuals as unknowns no search ends, and the points are kept.
        if !found.is_empty() {
            kept = found.iter().map(|found| found.x.clone()).collect();
        }
    }
    found.into_iter().next().ok_or_else(|| Error::Refused {
        finding: format!("no start of the model \"{}\" has a motion", model.form.sharing.name()),
        remedy: "give longer records, or check frequencies and units of the modes",
    })
}

/// Searches on from where [`grown`] ended before its minimum, in those models from number `first` on that may be the best of `all`: a search that has not reached its
/// minimum would speak against its model by how far it still has to go.
pub(super) fn through(all: &mut [(CoupledModel<'_>, Found)], first: usize) {
    let least = all.iter().map(|(_, found)| found.cost).fold(f64::INFINITY, f64::min);
    for (model, found) in all[first..].iter_mut().filter(|(_, found)| found.cost <= NEAR_BEST * least) {
        for _ in 0..FURTHER {
            if found.converged {
                break;
            }
            *found = settled(model, &found.x).unwrap_or_else(|| found.clone());
        }
    }
}

/// The starts that leave the smallest sum of squares in the first window.
fn nearest(model: &mut CoupledModel<'_>, starts: &[Vec<f64>]) -> Vec<Vec<f64>> {
    if starts.len() <= SEARCHED {
        return starts.to_vec();
    }
    model.take(WINDOWS[0].0);
    let threads = std::mem::replace(&mut model.threads, 1);
    let left = in_parallel(starts, threads, &|x| {
        let mut residuals = vec![0.0; model.count()];
        let known = model.evaluate(x, &mut residuals, None);
        if known { residuals.iter().map(|r| r * r).sum::<f64>() } else { f64::INFINITY }
    });
    model.threads = threads;
    let mut all: Vec<(f64, &Vec<f64>)> = left.into_iter().zip(starts).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    all.into_iter().take(SEARCHED).map(|(_, x)| x.clone()).collect()
}

/// The last search, from a point at which another search ended; none where that point has no motion.
pub(super) fn settled(model: &CoupledModel<'_>, x: &[f64]) -> Option<Found> {
    let free: Vec<usize> = (0..model.form.unknowns.len()).collect();
    near(model, x, &free, LAST)
}

/// Sets the standard deviation of each series from its residuals, but to no less than half the median of all, relative to the series' size: a series that a
/// modal model happens to meet well is not worth more than the model is.
pub(super) fn reweight(model: &mut CoupledModel<'_>, found: &Found) {
    let weights = weights(model, found);
    let relative = |(series, w): (&super::model::Series, &f64)| w * series.deviation / series.size;
    let all: Vec<f64> = model.series.iter().zip(&weights.deviations).map(relative).collect();
    let mut sorted = all.clone();
    sorted.sort_by(f64::total_cmp);
    let floor = 0.5 * sorted[sorted.len() / 2];
    for (series, relative) in model.series.iter_mut().zip(all) {
        series.deviation = (relative.max(floor) * series.size).max(f64::MIN_POSITIVE);
    }
}

/// Whether residuals whose correlation widens variances by `inflation` are as independent as white noise.
pub(super) fn is_white(inflation: f64) -> bool {
    inflation <= WHITE
}

/// Standard deviations of the series, in units of their present ones, and how far the correlation of neighbours widens variances. In a mode's windows each part of the complex
/// amplitude is correlated with the same part of the next window, not with the other part of its own.
pub(super) fn weights(model: &CoupledModel<'_>, found: &Found) -> Weights {
    let mut residuals = vec![0.0; model.count()];
    model.evaluate(&found.x, &mut residuals, None);
    let (mut sorted, mut ranges) = (Vec::with_capacity(residuals.len()), Vec::new());
    let parts = |series: &super::model::Series| series.sums.parts();
    for (series, range) in model.series.iter().zip(model.ranges()) {
        for part in 0..parts(series) {
            let first = sorted.len();
            sorted.extend(residuals[range.clone()].iter().skip(part).step_by(parts(series)));
            ranges.push(first..sorted.len());
        }
    }
    let found = Weights::of(&sorted, &ranges, found.x.len());
    let mut own = found.deviations.into_iter();
    let together = |series| {
        let all: Vec<f64> = own.by_ref().take(parts(series)).collect();
        (all.iter().map(|d| d * d).sum::<f64>() / all.len() as f64).sqrt()
    };
    let deviations = model.series.iter().map(together).collect();
    Weights { deviations, inflation: found.inflation }
}
