//! Intervals by profile likelihood: one parameter is held and all others follow, until the data contradict.
//!
//! As with ring-downs, the sum of squares has a crease wherever a measured amplitude equals the knee φ_max, so that a walk with the knee free ends in
//! the crease next to it: with such walks, of sixty tests with macro-slip the intervals of β held the truth in 24. Therefore walks begin at each end of the values that
//! are accepted along all knees, and keep the knee of that end.

use iwan_machine::threads::in_parallel;

use super::region::region;
use super::task::Task;
use crate::parameters::Parameter;
use crate::profile::{Profile, Region, Scale, Walk};
use crate::search::Minimum;

/// A point is a better minimum where its sum of squares is this far below the least one.
const BETTER: f64 = -0.1;

/// What is known of a minimum before intervals are taken.
#[derive(Debug, Clone, Copy)]
pub(super) struct Known {
    /// Whether macro-slip is seen. Else noise may be described a little better with it, and of K_T and F_S only a lower end is told.
    pub(super) slips: bool,
    /// Whether a better point that is met is passed over.
    pub(super) settled: bool,
    /// Deviance at the ends of the intervals.
    pub(super) limit: f64,
}

/// The profiles of all six parameters; the error is a better minimum.
pub(super) fn profiles(task: &Task<'_>, minimum: &Minimum, known: Known) -> Result<Vec<Profile>, Minimum> {
    let settled = known.settled || !known.slips;
    let better = if settled { f64::NEG_INFINITY } else { BETTER };
    // The errors of the data were estimated, so that the residuals' variance is 1.
    let scale = Scale { least: minimum.cost, variance: 1.0, limit: known.limit, better, even: false };
    let region = region(task, minimum, &scale)?;
    // A better point that a walk meets beside the region comes from the searches' tolerance, not from another valley (local minimum).
    let scale = Scale { better: f64::NEG_INFINITY, ..scale };
    let one = |parameter: &Parameter| profile(task, minimum, *parameter, known.slips, &region, &scale);
    Ok(in_parallel(&Parameter::ALL, Parameter::ALL.len(), &one))
}

fn profile(
    task: &Task<'_>,
    minimum: &Minimum,
    parameter: Parameter,
    slips: bool,
    region: &Region,
    scale: &Scale,
) -> Profile {
    let held = task.held.contains(&parameter);
    let value = task.chart.parameters(&minimum.x).get(parameter);
    region.profile(task, value, (parameter, held), slips, &|direction, points| {
        let farthest = region.farthest(task, scale, parameter, direction)?;
        let holding = task.holding(parameter);
        let coordinate = holding.chart.index(parameter)?;
        let start = Minimum { x: holding.carried(task, &farthest.x).ok()?, ..*farthest };
        let free: Vec<usize> = holding.smooth(&start.x).into_iter().filter(|j| *j != coordinate).collect();
        let walk = Walk::new(&holding, coordinate, free, &start, scale);
        let end = walk.end(parameter, direction, points)?;
        let value = holding.chart.parameters(&end).get(parameter);
        Some(region.outermost(task, parameter, direction, value))
    })
}
