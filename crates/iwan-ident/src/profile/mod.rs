//! Profile likelihood: what a record tells about each parameter, and where it tells nothing.
//!
//! A parameter is held at a value and all others follow; the rise of the weighted sum of squares over its least value, in
//! units of the residual variance, is the deviance. The 95 % interval reaches to where it is the square of Student's t.
//! Where it never gets there, up to the edge of what a model can be, the interval is open. Reference: D. M. Bates,
//! D. G. Watts, *Nonlinear Regression Analysis and Its Applications*, Wiley 1988, Sec. 6.1 (profile t).

mod outcome;
mod deviance;
mod charting;
mod walk;

use crate::parameters::Parameter;
use crate::refine::{Task, Workspace};
use crate::search::Minimum;
use deviance::Scale;
pub use outcome::{Profile, ProfilePoint, Profiles};
use walk::{End, Walk};

/// Macro-slip is seen when the best fit without it has a deviance above this: Akaike's criterion for two parameters.
const SLIP_SEEN: f64 = 4.0;

/// How far the model is taken for granted about a minimum.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Extent {
    /// All parameters follow.
    Full,
    /// The records do not see macro-slip: the minimum is that without it, although noise may be told a little better with
    /// it. Of K_T and F_S only the least that the records need is known.
    MicroSlip,
}

/// A minimum and what is taken for granted about it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Known<'a> {
    pub(crate) minimum: &'a Minimum,
    /// The best fit without macro-slip.
    pub(crate) micro_slip: Option<&'a Minimum>,
    pub(crate) extent: Extent,
    /// Whether a better point, should a walk meet one, is passed over: else the walk ends there.
    pub(crate) settled: bool,
}

/// The profiles about a minimum; a better point when there is one and nothing is settled.
pub(crate) fn profiles(task: &Task, known: Known<'_>) -> Result<Profiles, Minimum> {
    let scale = Scale::new(task, known.minimum, known.settled);
    let results: Vec<Result<Profile, Minimum>> = std::thread::scope(|scope| {
        let (task, scale) = (&*task, &scale);
        let handles: Vec<_> = Parameter::ALL
            .iter()
            .map(|parameter| scope.spawn(move || profile(task, known, scale, *parameter)))
            .collect();
        let joined =
            handles.into_iter().map(|h| h.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
        joined.collect()
    });
    let best = results.iter().filter_map(|r| r.as_ref().err()).min_by(|a, b| a.cost.total_cmp(&b.cost));
    if let Some(best) = best {
        return Err(best.clone());
    }
    Ok(Profiles {
        parameters: results.into_iter().flatten().collect(),
        limit: scale.limit,
        variance: scale.variance,
    })
}

/// Whether the records see macro-slip: what they have against the best fit without it. Also where a held parameter
/// decides that, so that there is no such fit.
pub(crate) fn slip_seen(task: &Task, minimum: &Minimum, micro_slip: Option<&Minimum>) -> bool {
    let scale = Scale::new(task, minimum, true);
    micro_slip.is_none_or(|m| scale.deviance(m, minimum) > SLIP_SEEN)
}

fn profile(task: &Task, known: Known<'_>, scale: &Scale, parameter: Parameter) -> Result<Profile, Minimum> {
    let value = task.chart.parameters(&known.minimum.x).get(parameter);
    let held = task.held().contains(&parameter);
    let points = vec![ProfilePoint { value, deviance: 0.0 }];
    let mut profile = Profile { parameter, value, low: None, high: None, points, held };
    let unseen = [Parameter::KT, Parameter::FS, Parameter::Beta];
    let one_sided = known.extent == Extent::MicroSlip && unseen.contains(&parameter);
    if held || (one_sided && parameter == Parameter::Beta) {
        return Ok(profile);
    }
    let chart = task.charting(parameter);
    let minimum = chart.from(task, known.minimum);
    let micro_slip = known.micro_slip.map(|m| chart.from(task, m));
    let value = |x: &[f64]| chart.chart.parameters(x).get(parameter);
    let coordinate = chart.chart.index(parameter);
    let free: Vec<usize> = chart.free().into_iter().filter(|j| *j != coordinate).collect();
    for direction in if one_sided { &[-1.0][..] } else { &[-1.0, 1.0] } {
        let mut walk = Walk {
            task: &chart,
            parameter,
            coordinate,
            free: free.clone(),
            minimum: &minimum,
            micro_slip: micro_slip.as_ref(),
            scale,
            better: if known.extent == Extent::MicroSlip { f64::NEG_INFINITY } else { scale.better },
            unseen: one_sided,
            tangent: None,
            work: Workspace::default(),
            visited: vec![],
        };
        let end = walk.go(*direction).map_err(|better| chart.back(&better))?;
        let at = match end {
            End::Open => None,
            End::Closed(x) => {
                let mut full = walk.nearest(x);
                full[walk.coordinate] = x;
                Some(value(&full))
            }
        };
        if *direction < 0.0 {
            profile.low = at;
        } else {
            profile.high = at;
        }
        let point = |v: &walk::Visited| ProfilePoint { value: value(&v.x), deviance: v.deviance };
        profile.points.extend(walk.visited.iter().map(point));
    }
    profile.points.sort_by(|a, b| a.value.total_cmp(&b.value));
    Ok(profile)
}
