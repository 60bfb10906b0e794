//! The minimum to which no profile finds a better one.

use crate::error::Error;
use crate::parameters::Parameters;
use crate::profile::{Extent, Known, Profiles, SLIP_SEEN, extent, profiles};
use crate::refine::{Clean, Solved, Task, Workspace};
use crate::search::Minimum;

/// Most searches that begin anew because a profile found a better minimum. A judgement: each costs as much as all profiles together. When they are
/// spent the profiles are taken as they are, and points below the minimum count as on it.
const ANEW: usize = 3;

/// Relative residual below which the fit in micro-slip is sought from other powers χ too. With so little noise valleys (local minima) are narrow, and
/// a short record, whose dissipation is not seen to change, begins its searches anywhere. Above this residual noise fills the valleys.
const QUIET: f64 = 2e-3;

/// A minimum, and the profiles about it.
pub(super) struct Found {
    pub(super) minimum: Minimum,
    pub(super) profiles: Profiles,
}

/// Searches until no profile finds a better minimum. Where the records do not see macro-slip the result is the best fit without it.
pub(super) fn minimum_and_profiles(task: &mut Task, first: &Parameters) -> Result<Found, Error> {
    let Solved { best, micro_slip } = task.solve(first)?;
    let start = task.coordinates(first)?;
    let mut minimum = task.finished(&best, &start)?;
    let mut near = micro_slip.map(|m| m.x);
    let mut round = 0;
    loop {
        let without = without_macro_slip(task, near.as_deref(), &minimum);
        let extent = extent(task, &minimum, without.as_ref().map(|w| &w.minimum));
        let clean = task.clean(&minimum);
        // Macro-slip is seen, but not beyond what the law may miss: the intervals are those without macro-slip, the best values those with it.
        let explained = match &without {
            Some(without) if clean == Some(Clean::Nearly) && extent != Extent::MicroSlip => {
                without.explains(&minimum)?
            }
            _ => false,
        };
        let extent = if explained { Extent::MicroSlip } else { extent };
        near = without.as_ref().map(|w| w.minimum.x.clone());
        let (open, lowest) = match without {
            Some(without) if extent == Extent::MicroSlip => without.discounted(&[&start, &minimum.x])?,
            _ => (task.clone(), minimum.clone()),
        };
        if !explained {
            (*task, minimum) = (open.clone(), lowest.clone());
        }
        let (widened, least) = match clean {
            Some(clean) if clean == Clean::Nearly || extent != Extent::Full => {
                open.widened(&lowest, clean)?
            }
            _ => (open, lowest),
        };
        let known = Known { minimum: &least, given: &minimum.x, extent, settled: round >= ANEW };
        match profiles(&widened, known) {
            Ok(profiles) => {
                *task = widened;
                if explained {
                    task.take_samples(&minimum.x, &mut Workspace::default());
                }
                let cost = task.cost(&minimum.x, &mut Workspace::default()).unwrap_or(minimum.cost);
                return Ok(Found { minimum: Minimum { cost, ..minimum }, profiles });
            }
            Err(better) => match task.resume(&better, &minimum) {
                Some(deeper) => minimum = task.finished(&deeper, &start)?,
                None => round = ANEW,
            },
        }
        round += 1;
    }
}

/// The best fit without macro-slip, and its task with what sampling adds to that ring-down: each of two fits that are compared is sampled as the
/// record was.
struct WithoutMacroSlip {
    task: Task,
    minimum: Minimum,
}

impl WithoutMacroSlip {
    /// The minimum with a discount for what this fit is found to miss, and its task; `others` are further starts.
    fn discounted(mut self, others: &[&[f64]]) -> Result<(Task, Minimum), Error> {
        let minimum = self.task.discounted(self.minimum, others)?;
        Ok((self.task, minimum))
    }

    /// Whether what the law may miss of a clean record explains the gain as well as macro-slip does.
    fn explains(&self, minimum: &Minimum) -> Result<bool, Error> {
        let gain = self.task.slip_gains(&self.minimum, minimum)?;
        Ok(gain.is_some_and(|gain| gain <= SLIP_SEEN))
    }
}

fn without_macro_slip(task: &Task, near: Option<&[f64]>, minimum: &Minimum) -> Option<WithoutMacroSlip> {
    let quiet = task.refined(minimum).relative_residual < QUIET;
    let others = if quiet { task.other_powers(&minimum.x) } else { vec![] };
    let near = near.into_iter().chain([minimum.x.as_slice()]);
    let from: Vec<&[f64]> = near.chain(others.iter().map(Vec::as_slice)).collect();
    let first = task.micro_slip(&from)?;
    let mut task = task.clone();
    task.take_samples(&first.x, &mut Workspace::default());
    let minimum = task.micro_slip(&[&first.x])?;
    Some(WithoutMacroSlip { task, minimum })
}
