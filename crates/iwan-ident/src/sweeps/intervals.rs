//! Intervals by profile likelihood: a parameter is held, all others follow, until the data contradict.
//!
//! As with ring-downs, the sum of squares has a crease wherever an amplitude equals the knee, so that a walk with the knee free ends in
//! the crease next to it: of sixty tests with macro-slip the intervals of β held 24. Therefore walks begin at each end of what is accepted
//! along all knees, and keep theirs.

use iwan_machine::threads::in_parallel;

use super::region::region;
use super::task::Task;
use crate::parameters::Parameter;
use crate::profile::{Profile, Region, Scale, Walk};
use crate::search::Minimum;

/// A sum of squares this far below the least is a better minimum.
const BETTER: f64 = -0.1;

/// What is taken for granted about a minimum.
#[derive(Debug, Clone, Copy)]
pub(super) struct Known {
    /// Whether macro-slip is seen: else noise may be told a little better with it, and of K_T and F_S only the least is told.
    pub(super) slips: bool,
    /// Whether a better point, should one be met, is passed over.
    pub(super) settled: bool,
    /// Deviance at the ends.
    pub(super) limit: f64,
}

/// All six profiles; or a better minimum.
pub(super) fn profiles(task: &Task<'_>, minimum: &Minimum, known: Known) -> Result<Vec<Profile>, Minimum> {
    let settled = known.settled || !known.slips;
    let better = if settled { f64::NEG_INFINITY } else { BETTER };
    // Errors were estimated: the residuals' variance is 1.
    let scale = Scale { least: minimum.cost, variance: 1.0, limit: known.limit, better };
    let region = region(task, minimum, &scale)?;
    // What a walk meets beside the region is a tolerance of the searches, not another valley.
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
