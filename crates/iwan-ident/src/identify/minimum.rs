//! The minimum that no profile finds a better one to.

use crate::error::Error;
use crate::parameters::Parameters;
use crate::profile::{Extent, Known, Profiles, profiles, slip_seen};
use crate::refine::Task;
use crate::search::Minimum;

/// Searches that begin anew because a profile found a better minimum, at most. A judgement: each costs as much as all
/// profiles together. When they are spent the profiles are taken as they are, and points below the minimum count as on it.
const ANEW: usize = 6;

/// A minimum and the profiles about it.
pub(super) struct Found {
    pub(super) minimum: Minimum,
    pub(super) profiles: Profiles,
}

/// Searches until no profile finds a better minimum. Where the records do not see macro-slip, the best fit without it.
pub(super) fn minimum_and_profiles(task: &mut Task, first: &Parameters) -> Result<Found, Error> {
    let mut minimum = task.solve(first)?;
    let first = task.coordinates(first)?;
    let (mut round, mut finished) = (0, false);
    loop {
        let micro_slip = task.micro_slip(&[&minimum.x, &first]);
        let extent =
            if slip_seen(task, &minimum, micro_slip.as_ref()) { Extent::Full } else { Extent::MicroSlip };
        match (extent, &micro_slip) {
            (Extent::MicroSlip, Some(without)) => minimum = without.clone(),
            _ if finished => {}
            _ => {
                (minimum, finished) = (task.finish(&minimum)?, true);
                continue;
            }
        }
        let known =
            Known { minimum: &minimum, micro_slip: micro_slip.as_ref(), extent, settled: round > ANEW };
        match profiles(task, known) {
            Ok(profiles) => return Ok(Found { minimum, profiles }),
            Err(better) => match task.resume(&better, &minimum) {
                Some(deeper) if round < ANEW => minimum = deeper,
                _ => round = ANEW,
            },
        }
        round += 1;
    }
}
