//! The end of an interval: where the records contradict a parameter at every knee.
//!
//! The sum of squares is smooth only where the knee is held, so a walk keeps its own knee. Where the walk ends, other knees may still accept the
//! value; from one that does the walk goes on.

use super::accepted::Region;
use super::deviance::Scale;
use super::outcome::ProfilePoint;
use super::walk::Walk;
use crate::parameters::Parameter;
use crate::refine::{Task, Workspace};
use crate::search::{DIRAC, Minimum};

/// Most times that a walk goes on from another knee. In noise of 20 dB most ends need one or none; where they are spent the end stands where the last
/// walk ended.
const FURTHER: usize = 4;
/// Other knees that are tried at an end, the likeliest by the linearised model. A scan of all knees there held the truth no more often, and took half
/// as long again.
const TRIED: usize = 4;
/// Least distance of these knees from each other, in ln φ_max: nearer ones tell the same under noise. A judgement.
const APART: f64 = 0.1;
/// Most times the deviance that the linearised model foretells outside the limit at which a search confirms it. The other knees, for which it foretells more, are then not tried. A judgement: of
/// eighteen searches of a fit of fifteen records sixteen ended at 0.9 to 1.7 times what was foretold, two went astray.
const CONFIRMED: f64 = 2.0;
/// Part of the limit below which the deviance must lie for another knee to accept an end: what lies nearer to the limit is a tolerance of the
/// searches.
const ACCEPTS: f64 = 0.9;
/// Relative reduction of the sum of squares at which searches at other knees end: of some 200 residuals it moves the deviance by 0.02.
const TOLERANCE: f64 = 1e-4;

/// What the search for the ends of a parameter's interval needs.
pub(super) struct Ends<'a> {
    pub(super) task: &'a Task,
    /// The points that the records accept at each knee.
    pub(super) region: &'a Region,
    pub(super) scale: &'a Scale,
    pub(super) parameter: Parameter,
}

impl Ends<'_> {
    /// The end in a direction (-1: lower, 1: upper); none where the interval is open. Points that are met on the way are added to `points`.
    pub(super) fn seek(&self, direction: f64, points: &mut Vec<ProfilePoint>) -> Option<f64> {
        let farthest = self.region.farthest(self.task, self.scale, self.parameter, direction)?;
        let charting = self.task.charting(self.parameter);
        let coordinate = charting.chart.index(self.parameter)?;
        let mut start = charting.from(self.task, farthest);
        // Without noise valleys are so narrow that other knees are not tried.
        let mut further = if charting.is_free_of_noise(&start) { 0 } else { FURTHER };
        loop {
            let free = following(&charting, coordinate, &start.x);
            let walk = Walk::new(&charting, coordinate, free, &start, self.scale);
            let end = walk.end(self.parameter, direction, points)?;
            let other = if further > 0 { self.at_another_knee(&charting, coordinate, &end) } else { None };
            match other {
                Some(accepted) => start = accepted,
                None => return Some(charting.chart.parameters(&end).get(self.parameter)),
            }
            further -= 1;
        }
    }

    /// The best point at another knee that accepts the value which the coordinate has in `end`; none where no other knee does.
    fn at_another_knee(&self, charting: &Task, coordinate: usize, end: &[f64]) -> Option<Minimum> {
        let knee = charting.knee()?;
        let value = charting.chart.parameters(end).get(self.parameter);
        let (mut tried, mut work) = (vec![end[knee]], Workspace::default());
        let mut best: Option<Minimum> = None;
        let likeliest = self.region.likeliest_at(self.task, self.scale, self.parameter, value);
        for (foretold, accepted) in likeliest {
            let there = &accepted.minimum;
            if tried.iter().any(|k| (k - there.x[knee]).abs() < APART) {
                continue;
            }
            tried.push(there.x[knee]);
            let followed = accepted.towards(self.task, self.parameter, value);
            let mut moved = end.to_vec();
            moved[knee] = there.x[knee];
            // All else follows the value by the linearised model, stays as it is at the accepted point, or is as it is at the end.
            let beginnings = [
                charting.from(self.task, &Minimum { x: followed, ..there.clone() }).x,
                charting.from(self.task, there).x,
                moved,
            ];
            let at_value = |mut x: Vec<f64>| {
                x[coordinate] = end[coordinate];
                Some((charting.cost(&x, &mut work)?, x))
            };
            let nearest = beginnings.into_iter().filter_map(at_value).min_by(|a, b| a.0.total_cmp(&b.0));
            let Some((_, x)) = nearest else { continue };
            let found = charting.minimise(&x, following(charting, coordinate, &x), TOLERANCE, &mut work);
            let deviance = found.as_ref().map_or(f64::INFINITY, |found| self.scale.rise(found));
            best = best.into_iter().chain(found).min_by(|a, b| a.cost.total_cmp(&b.cost));
            let is_confirmed =
                foretold > self.scale.limit && deviance > self.scale.limit && deviance < CONFIRMED * foretold;
            if tried.len() > TRIED || is_confirmed {
                break;
            }
        }
        best.filter(|m| self.scale.rise(m) < ACCEPTS * self.scale.limit)
    }
}

/// The coordinates that follow at a held knee: all smooth ones but the walk's own, and without macro-slip not the Dirac, which is nowhere seen then.
fn following(charting: &Task, coordinate: usize, x: &[f64]) -> Vec<usize> {
    let unseen = |j: usize| j == DIRAC && charting.is_micro_slip(x);
    charting.smooth().into_iter().filter(|j| *j != coordinate && !unseen(*j)).collect()
}
