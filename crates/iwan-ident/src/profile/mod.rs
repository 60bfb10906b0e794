//! Profile likelihood: what records tell about each parameter, and where they tell nothing.
//!
//! One parameter is held at a value and all others follow. The deviance is the rise of the weighted sum of squares over its least value, in units of
//! the residuals' variance. The 95 % interval reaches to where the deviance is the square of Student's t. Where it never gets there, up to the edge
//! of what a model can be, the interval is open. Reference: D. M. Bates, D. G. Watts, *Nonlinear Regression Analysis and Its Applications*, Wiley
//! 1988, Sec. 6.1 (profile t).
//!
//! The sum of squares has a crease (a bend) wherever an amplitude of the ring-down equals the knee φ_max, so that a walk along a parameter can end in
//! a valley (a local minimum along the knee) of its own. Therefore the knee is taken through its whole range first, all others following. The points
//! that the records accept there are the region, and an interval is the reach of all of them together: it contains the parameter's value at each
//! point that any other profile accepts.

mod outcome;
mod deviance;
mod charting;
mod ground;
mod walk;
mod accepted;
mod ends;

use iwan_machine::threads::{both, in_parallel};

use crate::parameters::Parameter;
use crate::refine::Task;
use crate::search::{Chart, Minimum};
pub(crate) use accepted::{Charted, Region};
pub(crate) use deviance::Scale;
use ends::Ends;
pub(crate) use ground::{Ground, is_all_joint};
pub use outcome::{Profile, ProfilePoint, Profiles};
pub(crate) use walk::{End, Walk};

/// Deviance of the best fit without macro-slip above which macro-slip is seen. Two parameters more would gain 6 at the 95 % level; but the knee is
/// sought along its whole range, and noise alone was seen to gain 19.6. With 25, none of 40 records of Table 2's mode 1 at 0.3 φ_max and 40 dB claims
/// macro-slip.
pub(crate) const SLIP_SEEN: f64 = 25.0;
/// Largest amplitude over φ_max from which on the knee lies clearly inside the data: any small defect of a record's loud start (a second mode,
/// clipping, the hammer's rebound) looks like a knee just below the largest amplitude. Below this ratio K_T and F_S have no upper end, β has no end.
const CLEARLY_INSIDE: f64 = 1.1;

/// Half cycles of macro-slip that are needed for an upper end of K_T and F_S and for the ends of β: the first amplitude and phase are unknown,
/// and knee, Dirac and stiffness bring three unknowns more. With three half cycles or less two joints of quite different size can match the whole record alike.
const SLIPPING: usize = 4;

/// How much of the knee the records see.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Extent {
    /// Macro-slip is clearly seen: the records tell all parameters.
    Full,
    /// Something like macro-slip appears at the very largest amplitudes only. The best fit has macro-slip, but K_T and F_S have a lower end only.
    Edge,
    /// No macro-slip is seen: the minimum is the one without macro-slip, although noise may be matched a little better with it. Only the least K_T
    /// and F_S that the records need are known.
    MicroSlip,
}

/// A minimum, and what its profiles take for granted.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Known<'a> {
    pub(crate) minimum: &'a Minimum,
    /// The point whose parameters are reported: the minimum itself, or the minimum before intervals allow for what a law may miss. All intervals
    /// contain it.
    pub(crate) given: &'a [f64],
    pub(crate) extent: Extent,
    /// Whether a walk passes over a better point that it meets; otherwise the walk ends there.
    pub(crate) settled: bool,
}

/// The profiles about a minimum; as an error a better minimum, where there is one and nothing is settled.
pub(crate) fn profiles(task: &Task, known: Known<'_>) -> Result<Profiles, Minimum> {
    let settled = known.settled || known.extent == Extent::MicroSlip;
    let scale = Scale::new(task, known.minimum, settled);
    let region = region(task, known.minimum, &scale)?;
    // A lower sum of squares that a walk meets beside the region is a tolerance of the searches, and no other valley.
    let scale = Scale { better: f64::NEG_INFINITY, ..scale };
    let parameters = in_parallel(&Parameter::ALL, Parameter::ALL.len(), &|parameter| {
        profile(task, known, &region, &scale, *parameter)
    });
    Ok(Profiles { parameters, limit: scale.limit, variance: scale.variance })
}

/// How much of the knee the records see, by the deviance of the best fit without macro-slip (`micro_slip`). There is no such fit where given
/// parameters decide about macro-slip; the extent is full then.
pub(crate) fn extent(task: &Task, minimum: &Minimum, micro_slip: Option<&Minimum>) -> Extent {
    let scale = Scale::new(task, minimum, true);
    if micro_slip.is_some_and(|m| scale.rise(m) <= SLIP_SEEN) {
        Extent::MicroSlip
    } else if !task.is_open() {
        Extent::Full
    } else if task.is_beside_others() {
        // What remains of near modes beats through the whole record, and a knee follows the beats.
        Extent::Edge
    } else if task.slip_ratio(&minimum.x) < CLEARLY_INSIDE || task.slipping_half_cycles(&minimum.x) < SLIPPING
    {
        Extent::Edge
    } else {
        Extent::Full
    }
}

/// All points that the records accept: from the minimum along all knees, or the minimum alone where the knee is not sought.
fn region(task: &Task, minimum: &Minimum, scale: &Scale) -> Result<Region, Minimum> {
    let Some(knee) = task.knee() else {
        return Region::of(task, vec![minimum.clone()], None, scale);
    };
    let knees = task.knees();
    let range = [knees[knees.len() - 1], knees[0]];
    let limit = minimum.cost + scale.limit * scale.variance;
    let swept = || task.swept(minimum, limit, scale.tolerance_of_sweeps());
    let walked = |direction: &f64| {
        let mut walk = Walk::new(task, knee, task.smooth(), minimum, scale);
        walk.go(*direction).map(|_| walk.visited)
    };
    let (mut found, walks) = both(&swept, &|| in_parallel(&[-1.0, 1.0], 2, &walked));
    for visited in walks {
        found.extend(visited?.into_iter().map(|v| v.minimum));
    }
    Region::of(task, found, Some((knee, range)), scale)
}

fn profile(task: &Task, known: Known<'_>, region: &Region, scale: &Scale, parameter: Parameter) -> Profile {
    let held = task.held().contains(&parameter);
    let slips = known.extent == Extent::Full;
    let value = task.chart.parameters(known.given).get(parameter);
    region.profile(task, value, (parameter, held), slips, &|direction, points| {
        let end = Ends { task, region, scale, parameter }.seek(direction, points)?;
        Some(region.outermost(task, parameter, direction, end))
    })
}

impl Charted for Task {
    fn chart(&self) -> &Chart {
        &self.chart
    }

    fn smooth_at(&self, _: &[f64]) -> Vec<usize> {
        self.smooth()
    }
}
