//! Profile likelihood: what a record tells about each parameter, and where it tells nothing.
//!
//! A parameter is held at a value and all others follow; the rise of the weighted sum of squares over its least value, in
//! units of the residual variance, is the deviance. The 95 % interval reaches to where it is the square of Student's t.
//! Where it never gets there, up to the edge of what a model can be, the interval is open. Reference: D. M. Bates,
//! D. G. Watts, *Nonlinear Regression Analysis and Its Applications*, Wiley 1988, Sec. 6.1 (profile t).

mod walk;

use crate::chart::Chart;
use crate::least_squares::Minimum;
use crate::parameters::Parameter;
use crate::refine::{Task, Workspace};
use walk::{End, Walk};

/// 97.5 % point of the normal distribution: intervals hold 95 %.
const NORMAL: f64 = 1.959963984540054;
/// Macro-slip is seen when the best fit without it has a deviance above this: Akaike's criterion for two parameters.
const SLIP_SEEN: f64 = 4.0;
/// A deviance so far below zero is a better minimum.
const BETTER: f64 = -0.1;

/// What the records tell about one parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// Which one.
    pub parameter: Parameter,
    /// The value of the best fit.
    pub value: f64,
    /// Lower end of the 95 % interval; none: open.
    pub low: Option<f64>,
    /// Upper end of the 95 % interval; none: open.
    pub high: Option<f64>,
    /// Values and their deviances, ascending; the 95 % limit is [`Profiles::limit`].
    pub points: Vec<(f64, f64)>,
    /// Whether it was held and not sought.
    pub held: bool,
}

impl Profile {
    /// Whether the records bound the parameter on both sides.
    #[must_use]
    pub fn identifiable(&self) -> bool {
        !self.held && self.low.is_some() && self.high.is_some()
    }
}

/// The profiles of all six parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Profiles {
    /// In the order of [`Parameter::ALL`].
    pub parameters: Vec<Profile>,
    /// Deviance at the ends of the intervals: the square of Student's t.
    pub limit: f64,
    /// Variance of the whitened residuals that the deviances are in units of.
    pub(crate) variance: f64,
}

/// What all profiles of a task share.
struct Scale {
    /// Variance of the residuals in their unit.
    variance: f64,
    limit: f64,
    /// A deviance below this is a better minimum.
    better: f64,
}

impl Scale {
    fn new(task: &Task, minimum: &Minimum, settled: bool) -> Self {
        let freedom = (task.count() - task.free().len()) as f64;
        let refined = task.refined(minimum);
        let r = refined.correlation;
        // Neighbours that agree say the same twice.
        let inflation = if refined.leaves_noise(task.count()) { 1.0 } else { (1.0 + r) / (1.0 - r.min(0.9)) };
        Self {
            variance: inflation * (minimum.cost / freedom).max(task.least_variance()),
            limit: student(freedom / inflation).powi(2),
            better: if settled { f64::NEG_INFINITY } else { BETTER },
        }
    }

    fn deviance(&self, found: &Minimum, minimum: &Minimum) -> f64 {
        (found.cost - minimum.cost) / self.variance
    }
}

/// How far the model is taken for granted about a minimum.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Extent {
    /// All parameters follow.
    Full,
    /// The records do not see macro-slip: the minimum is that without it, although noise may be told a little better with
    /// it. Of K_T and F_S only the least that the records need is known.
    MicroSlip,
}

/// The profiles about the minimum; a better point when there is one, unless `settled`.
pub(crate) fn profiles(
    task: &Task,
    minimum: &Minimum,
    micro_slip: Option<&Minimum>,
    (extent, settled): (Extent, bool),
) -> Result<Profiles, Minimum> {
    let scale = Scale::new(task, minimum, settled);
    let results: Vec<Result<Profile, Minimum>> = std::thread::scope(|scope| {
        let (task, scale) = (&*task, &scale);
        let handles: Vec<_> = Parameter::ALL
            .iter()
            .map(|parameter| {
                scope.spawn(move || profile(task, (minimum, micro_slip), (scale, extent), *parameter))
            })
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

/// Deviance of the best fit without macro-slip about the best fit; none where a held parameter decides on that.
pub(crate) fn slip_seen(task: &Task, minimum: &Minimum, micro_slip: Option<&Minimum>) -> bool {
    let scale = Scale::new(task, minimum, true);
    micro_slip.is_none_or(|m| scale.deviance(m, minimum) > SLIP_SEEN)
}

fn profile(
    task: &Task,
    (minimum, micro_slip): (&Minimum, Option<&Minimum>),
    (scale, extent): (&Scale, Extent),
    parameter: Parameter,
) -> Result<Profile, Minimum> {
    let value = task.chart.parameters(&minimum.x).get(parameter);
    let held = task.held().contains(&parameter);
    let mut profile = Profile { parameter, value, low: None, high: None, points: vec![(value, 0.0)], held };
    let unseen = [Parameter::KT, Parameter::FS, Parameter::Beta];
    let one_sided = extent == Extent::MicroSlip && unseen.contains(&parameter);
    if held || (one_sided && parameter == Parameter::Beta) {
        return Ok(profile);
    }
    let chart = task.charting(parameter);
    let (minimum, micro_slip) = (chart.from(task, minimum), micro_slip.map(|m| chart.from(task, m)));
    let of = |x: &[f64]| chart.chart.parameters(x).get(parameter);
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
            better: if extent == Extent::MicroSlip { f64::NEG_INFINITY } else { scale.better },
            unseen: one_sided,
            tangent: None,
            work: Workspace::default(),
            points: vec![],
        };
        let end = walk.go(*direction).map_err(|better| chart.back(&better))?;
        let at = match end {
            End::Open => None,
            End::Closed(x) => {
                let mut full = walk.nearest(x);
                full[walk.coordinate] = x;
                Some(of(&full))
            }
        };
        if *direction < 0.0 {
            profile.low = at;
        } else {
            profile.high = at;
        }
        profile.points.extend(walk.points.iter().map(|p| (of(&p.2), p.1)));
    }
    profile.points.sort_by(|a, b| a.0.total_cmp(&b.0));
    Ok(profile)
}

/// 97.5 % point of Student's t with ν degrees of freedom: Abramowitz and Stegun 26.7.5, within 0.3 % from ν = 3 on.
fn student(freedom: f64) -> f64 {
    let (z, n) = (NORMAL, freedom.max(3.0));
    let z2 = z * z;
    let terms = [
        z * (z2 + 1.0) / 4.0,
        z * ((5.0 * z2 + 16.0) * z2 + 3.0) / 96.0,
        z * (((3.0 * z2 + 19.0) * z2 + 17.0) * z2 - 15.0) / 384.0,
        z * ((((79.0 * z2 + 776.0) * z2 + 1482.0) * z2 - 1920.0) * z2 - 945.0) / 92160.0,
    ];
    z + terms.iter().rev().fold(0.0, |sum, term| (sum + term) / n)
}

impl Task {
    /// The same task in the chart that has the parameter as a coordinate.
    fn charting(&self, parameter: Parameter) -> Self {
        let coordinates: Vec<Parameter> = self.held().iter().copied().chain([parameter]).collect();
        let mut task = self.clone();
        task.chart = Chart::holding(&coordinates, self.chart.amplitude);
        task
    }

    /// A minimum of another chart's task in the coordinates of this one.
    fn from(&self, other: &Self, minimum: &Minimum) -> Minimum {
        Minimum { x: other.converted(&self.chart, &minimum.x), ..*minimum }
    }

    /// A minimum of this task in the coordinates of every search.
    fn back(&self, minimum: &Minimum) -> Minimum {
        let usual = Chart::holding(self.held(), self.chart.amplitude);
        Minimum { x: self.converted(&usual, &minimum.x), ..*minimum }
    }

    /// Coordinates in another chart; as they are where the parameters are no model.
    fn converted(&self, chart: &Chart, x: &[f64]) -> Vec<f64> {
        let mut moved = x.to_vec();
        if let Ok(own) = chart.coordinates(&self.chart.parameters(x)) {
            moved[..own.len()].copy_from_slice(&own);
        }
        moved
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn student_as_tabled() {
        // Abramowitz and Stegun, Table 26.10.
        for (freedom, t) in [(3.0, 3.182), (5.0, 2.571), (10.0, 2.228), (30.0, 2.042), (120.0, 1.980)] {
            assert!((student(freedom) / t - 1.0).abs() < 3e-3, "{freedom}: {}", student(freedom));
        }
    }
}
