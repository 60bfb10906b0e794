//! Profile likelihood: what a record tells about each parameter, and where it tells nothing.
//!
//! A parameter is held at a value and all others follow; the rise of the weighted sum of squares over its least value, in
//! units of the residual variance, is the deviance. The 95 % interval reaches to where it is the square of Student's t.
//! Where it never gets there, up to the edge of what a model can be, the interval is open. Reference: D. M. Bates,
//! D. G. Watts, *Nonlinear Regression Analysis and Its Applications*, Wiley 1988, Sec. 6.1 (profile t).
//!
//! The sum of squares has a crease wherever an amplitude of the ring-down equals φ_max, so that a walk along a parameter can end
//! in a valley of its own. Therefore the knee is taken through its whole range first, all others following; the points that
//! the records accept there are the region, and an interval is the reach of all of them together: it contains each
//! parameter of every point that any other profile accepts.

mod outcome;
mod deviance;
mod charting;
mod ground;
mod walk;
mod accepted;
mod ends;

use iwan_machine::threads::in_parallel;

use crate::parameters::Parameter;
use crate::refine::{Task, Workspace};
use crate::search::{Chart, Minimum};
pub(crate) use accepted::{Charted, Region};
pub(crate) use deviance::Scale;
use ends::Ends;
pub(crate) use ground::{Ground, is_all_joint};
pub use outcome::{Profile, ProfilePoint, Profiles};
pub(crate) use walk::{End, Walk};

/// Macro-slip is seen when the best fit without it has a deviance above this. Two parameters more would gain 6 at the 95 %
/// level; but the knee is sought along its whole range, and noise alone was seen to gain 19.6. With 25, none of 40 records of Table 2's mode 1
/// at 0.3 φ_max and 40 dB claims macro-slip.
pub(crate) const SLIP_SEEN: f64 = 25.0;
/// The knee lies clearly inside the data when the largest amplitude is so many times φ_max: any small defect of a record's loud
/// start (a second mode, clipping, the hammer's rebound) looks like a knee just below the largest amplitude.
const CLEARLY_INSIDE: f64 = 1.1;

/// Half cycles of macro-slip that are needed: the first amplitude and phase are unknown, and knee, Dirac and stiffness bring three
/// unknowns more. With three half cycles or less two joints of quite different size can tell the whole record alike.
const SLIPPING: usize = 4;

/// How much of the knee the records see.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Extent {
    /// Macro-slip: all parameters follow.
    Full,
    /// Something like macro-slip at the very largest amplitudes: the best fit has it, but of K_T and F_S only the least is told.
    Edge,
    /// No macro-slip: the minimum is that without it, although noise may be told a little better with it. Of K_T and F_S only
    /// the least that the records need is known.
    MicroSlip,
}

/// A minimum and what is taken for granted about it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Known<'a> {
    pub(crate) minimum: &'a Minimum,
    /// The point whose parameters are given: the minimum itself, or that without what intervals allow for. It lies inside all intervals.
    pub(crate) given: &'a [f64],
    pub(crate) extent: Extent,
    /// Whether a better point, should a walk meet one, is passed over: else the walk ends there.
    pub(crate) settled: bool,
}

/// The profiles about a minimum; a better point when there is one and nothing is settled.
pub(crate) fn profiles(task: &Task, known: Known<'_>) -> Result<Profiles, Minimum> {
    let settled = known.settled || known.extent == Extent::MicroSlip;
    let scale = Scale::new(task, known.minimum, settled);
    let region = region(task, known.minimum, &scale)?;
    // What a walk meets beside the region is a tolerance of the searches, not another valley.
    let scale = Scale { better: f64::NEG_INFINITY, ..scale };
    let parameters = in_parallel(&Parameter::ALL, Parameter::ALL.len(), &|parameter| {
        profile(task, known, &region, &scale, *parameter)
    });
    Ok(Profiles { parameters, limit: scale.limit, variance: scale.variance })
}

/// How much of the knee the records see: what they have against the best fit without macro-slip. All of it where given
/// parameters decide that, so that there is no such fit.
pub(crate) fn extent(task: &Task, minimum: &Minimum, micro_slip: Option<&Minimum>) -> Extent {
    let scale = Scale::new(task, minimum, true);
    if micro_slip.is_some_and(|m| scale.rise(m) <= SLIP_SEEN) {
        Extent::MicroSlip
    } else if !task.is_open() {
        Extent::Full
    } else if task.is_beside_others() {
        // What is left of near modes beats through the whole record, and a knee follows it.
        Extent::Edge
    } else if task.slip_ratio(&minimum.x) < CLEARLY_INSIDE || task.slipping_half_cycles(&minimum.x) < SLIPPING
    {
        Extent::Edge
    } else {
        Extent::Full
    }
}

/// All points that the records accept, from the minimum along all knees, or where the knee is not sought the minimum alone.
fn region(task: &Task, minimum: &Minimum, scale: &Scale) -> Result<Region, Minimum> {
    let mut work = Workspace::default();
    let Some(knee) = task.knee() else {
        return Region::of(task, vec![minimum.clone()], None, scale, &mut work);
    };
    let knees = task.knees();
    let range = [knees[knees.len() - 1], knees[0]];
    let limit = minimum.cost + scale.limit * scale.variance;
    let mut found = task.sweep(minimum, limit, scale.tolerance());
    found.extend(task.polished(&found));
    let walked = |direction: &f64| {
        let mut walk = Walk::new(task, knee, task.smooth(), minimum, scale);
        walk.go(*direction).map(|_| walk.visited)
    };
    for visited in in_parallel(&[-1.0, 1.0], 2, &walked) {
        found.extend(visited?.into_iter().map(|v| v.minimum));
    }
    Region::of(task, found, Some((knee, range)), scale, &mut work)
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
