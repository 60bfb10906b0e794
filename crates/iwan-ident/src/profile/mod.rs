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
mod walk;
mod accepted;

use crate::parameters::Parameter;
use crate::refine::Task;
use crate::search::{DIRAC, Minimum};
use accepted::{Accepted, Region, scaled};
use deviance::Scale;
pub use outcome::{Profile, ProfilePoint, Profiles};
use walk::{End, Walk};

/// Macro-slip is seen when the best fit without it has a deviance above this. Two parameters more would gain 6 at the 95 %
/// level; but the knee is sought along its whole range, and noise alone was seen to gain 19.6. With 25, none of 40 records of Table 2's mode 1
/// at 0.3 φ_max and 40 dB claims macro-slip.
const SLIP_SEEN: f64 = 25.0;
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
    pub(crate) extent: Extent,
    /// Whether a better point, should a walk meet one, is passed over: else the walk ends there.
    pub(crate) settled: bool,
}

/// The profiles about a minimum; a better point when there is one and nothing is settled.
pub(crate) fn profiles(task: &Task, known: Known<'_>) -> Result<Profiles, Minimum> {
    let settled = known.settled || known.extent == Extent::MicroSlip;
    let scale = Scale::new(task, known.minimum, settled);
    let region = Region::new(task, known.minimum, &scale)?;
    // What a walk meets beside the region is a tolerance of the searches, not another valley.
    let scale = Scale { better: f64::NEG_INFINITY, ..scale };
    let parameters = std::thread::scope(|scope| {
        let (region, scale) = (&region, &scale);
        let handles: Vec<_> = Parameter::ALL
            .iter()
            .map(|parameter| scope.spawn(move || profile(task, known, region, scale, *parameter)))
            .collect();
        let joined =
            handles.into_iter().map(|h| h.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
        joined.collect()
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
    } else if task.slip_ratio(&minimum.x) < CLEARLY_INSIDE || task.slipping_half_cycles(&minimum.x) < SLIPPING
    {
        Extent::Edge
    } else {
        Extent::Full
    }
}

fn profile(task: &Task, known: Known<'_>, region: &Region, scale: &Scale, parameter: Parameter) -> Profile {
    let value = task.chart.parameters(&known.minimum.x).get(parameter);
    let held = task.held().contains(&parameter);
    let mut points: Vec<ProfilePoint> = region
        .points
        .iter()
        .map(|p| ProfilePoint { value: p.value(task, parameter), deviance: p.deviance })
        .collect();
    let mut profile = Profile { parameter, value, low: None, high: None, points: vec![], held };
    if !held {
        let told = |low: bool| is_told(known.extent, region, parameter, low);
        if told(true) {
            profile.low = end(task, region, scale, parameter, -1.0, &mut points);
        }
        if told(false) {
            profile.high = end(task, region, scale, parameter, 1.0, &mut points);
        }
    }
    points.sort_by(|a, b| a.value.total_cmp(&b.value).then(a.deviance.total_cmp(&b.deviance)));
    points.dedup_by(|later, kept| later.value == kept.value);
    Profile { points, ..profile }
}

/// Whether the records can tell this end of a parameter at all.
fn is_told(extent: Extent, region: &Region, parameter: Parameter, low: bool) -> bool {
    let full = extent == Extent::Full;
    match parameter {
        Parameter::KT | Parameter::FS if low => !region.to_smallest_knee,
        Parameter::KT | Parameter::FS => full && !region.to_largest_knee,
        Parameter::Beta => full && !region.to_largest_knee && !region.to_smallest_knee,
        _ => true,
    }
}

/// The end of an interval in a direction: the farthest that any point of the region reaches; none where it is open.
fn end(
    task: &Task,
    region: &Region,
    scale: &Scale,
    parameter: Parameter,
    direction: f64,
    points: &mut Vec<ProfilePoint>,
) -> Option<f64> {
    let reached = |p: &Accepted| {
        direction * scaled(parameter, p.value(task, parameter)) + p.reach(task, scale, parameter)
    };
    let farthest = region.points.iter().max_by(|a, b| reached(a).total_cmp(&reached(b)))?;
    let chart = task.charting(parameter);
    let minimum = chart.from(task, &farthest.minimum);
    let coordinate = chart.chart.index(parameter)?;
    // Without macro-slip the Dirac is nowhere seen.
    let unseen = |j: usize| j == DIRAC && chart.is_micro_slip(&minimum.x);
    let free: Vec<usize> = chart.smooth().into_iter().filter(|j| *j != coordinate && !unseen(*j)).collect();
    let value = |x: &[f64]| chart.chart.parameters(x).get(parameter);
    let mut walk = Walk::new(&chart, coordinate, free, &minimum, scale);
    walk.stiffness_ends = matches!(parameter, Parameter::KT | Parameter::FS | Parameter::Beta);
    let found = walk.go(direction).unwrap_or(End::Open);
    points.extend(
        walk.visited.iter().map(|v| ProfilePoint { value: value(&v.minimum.x), deviance: v.deviance }),
    );
    let End::Closed(at) = found else { return None };
    let mut x = walk.nearest(at);
    x[coordinate] = at;
    // No accepted point lies outside.
    let all = region.points.iter().map(|p| p.value(task, parameter)).chain([value(&x)]);
    all.reduce(|a, b| if direction < 0.0 { a.min(b) } else { a.max(b) })
}
