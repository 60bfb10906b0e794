//! Profile likelihood: what a record tells about each parameter, and where it tells nothing.
//!
//! A parameter is held at a value and all others follow; the rise of the weighted sum of squares over its least value, in
//! units of the residual variance, is the deviance. The 95 % interval reaches to where it is the square of Student's t.
//! Where it never gets there, up to the edge of what a model can be, the interval is open. Reference: D. M. Bates,
//! D. G. Watts, *Nonlinear Regression Analysis and Its Applications*, Wiley 1988, Sec. 6.1 (profile t).

use crate::chart::Chart;
use crate::least_squares::{Minimum, following};
use crate::parameters::{Parameter, Parameters};
use crate::refine::{KNEE_UNSEEN, Task, Workspace};

/// 97.5 % point of the normal distribution: intervals hold 95 %.
const NORMAL: f64 = 1.959963984540054;
/// An interval that reaches this far from its value, in coordinates (logarithms, mostly), is open.
const FARTHEST: f64 = 7.0;
/// First step when the curvature says nothing.
const FIRST_STEP: f64 = 0.1;
/// How far a line through two points is followed, in distances between them.
const FARTHEST_AHEAD: f64 = 5.0;
/// Steps below the largest amplitude.
const CLOSE: f64 = 0.15;
/// Beginnings that are tried at most.
const WAYS: usize = 3;
/// Steps outwards, and rounds to bring an end to the precision.
const OUTWARDS: usize = 24;
const INWARDS: usize = 16;
/// Roots of deviances this many times the limit's are too far for a straight line.
const FAR_OUTSIDE: f64 = 4.0;
/// Relative precision of the distance of an end, as the root of the deviance.
const PRECISION: f64 = 5e-3;
/// Macro-slip is seen when the best fit without it has a deviance above this: Akaike's criterion for two parameters.
const SLIP_SEEN: f64 = 4.0;
/// A deviance so far below zero is a better minimum.
const BETTER: f64 = -0.1;
/// Relative reduction of the sum of squares at which a search along a profile ends: a hundredth of the residuals'
/// variance, nearly.
const TOLERANCE: f64 = 1e-5;
/// Where only a K_T of nearly ω0² would allow more, the end is not the record's.
const MOST_JOINT: f64 = 0.9;

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

/// A walk along one coordinate.
struct Walk<'a> {
    task: &'a Task,
    parameter: Parameter,
    coordinate: usize,
    /// The coordinates that follow.
    free: Vec<usize>,
    minimum: &'a Minimum,
    /// The best without macro-slip: a plateau that a walk on the crest of some cycle's first slip would not see.
    micro_slip: Option<&'a Minimum>,
    scale: &'a Scale,
    /// A deviance below this is a better minimum.
    better: f64,
    /// Whether the record shows no upper end: the walk leads down to where φ_max meets the largest amplitude.
    unseen: bool,
    /// How the others follow next to the minimum, per unit of the coordinate.
    tangent: Option<Vec<f64>>,
    work: Workspace,
    /// Coordinate, deviance and all coordinates of each point.
    points: Vec<(f64, f64, Vec<f64>)>,
}

/// How a walk ended.
enum End {
    Open,
    Closed(f64),
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

impl Walk<'_> {
    /// Deviance with the coordinate held at `at`; none where there is no model.
    ///
    /// From the nearest known point there are several ways to begin; the likeliest is taken, the others only where
    /// it says that the record forbids the value.
    fn deviance(&mut self, at: f64) -> Result<Option<f64>, Minimum> {
        let mut beginnings = self.beginnings(at, &self.nearest(at));
        beginnings.push(self.ahead(at));
        beginnings.extend(self.micro_slip.into_iter().flat_map(|m| self.beginnings(at, &m.x)));
        let mut ways: Vec<(f64, Vec<f64>)> =
            beginnings.into_iter().filter_map(|x| Some((self.task.cost(&x, &mut self.work)?, x))).collect();
        ways.sort_by(|a, b| a.0.total_cmp(&b.0));
        ways.truncate(WAYS);
        let mut best: Option<Minimum> = None;
        for (_, x) in ways {
            let found = self.task.minimise(&x, self.free.clone(), TOLERANCE, &mut self.work);
            best = best.into_iter().chain(found).min_by(|a, b| a.cost.total_cmp(&b.cost));
            let limit = self.minimum.cost + self.scale.limit * self.scale.variance;
            if best.as_ref().is_some_and(|b| b.cost < limit) {
                break;
            }
        }
        let Some(found) = best else { return Ok(None) };
        let deviance = self.scale.deviance(&found, self.minimum);
        if deviance < self.better {
            return Err(found);
        }
        self.points.push((at, deviance.max(0.0), found.x));
        Ok(Some(deviance.max(0.0)))
    }

    /// A point with the coordinate moved: all others as they are; φ_max and the power law as they are, the Dirac making
    /// up for it; no Dirac at all.
    fn beginnings(&self, at: f64, near: &[f64]) -> Vec<Vec<f64>> {
        let chart = self.task.chart;
        let mut plain = near.to_vec();
        plain[self.coordinate] = at;
        let (p, target) = (chart.parameters(near), chart.parameters(&plain).get(self.parameter));
        let mut all = vec![plain];
        let Ok((_, joint)) = p.model() else { return all };
        let power = joint.r() * joint.phi_max().powf(p.chi + 1.0) / (p.chi + 1.0);
        let c = (p.chi + 1.0) / (p.chi + 2.0);
        let dirac = match self.parameter {
            Parameter::KT => Some(target - power),
            Parameter::FS => Some(target / joint.phi_max() - power * c),
            Parameter::Beta => Some(target * power),
            _ => None,
        };
        let same_knee = dirac.filter(|s| *s >= 0.0).map(|s| (power, s, joint.phi_max()));
        // Without the Dirac K_T is R φ^(χ+1)/(χ+1) and F_S is c φ times that.
        let without = match self.parameter {
            Parameter::KT => {
                Some((target, 0.0, joint.phi_max() * (target / power).powf(1.0 / (p.chi + 1.0))))
            }
            Parameter::FS => {
                let growth = (target / (power * c * joint.phi_max())).powf(1.0 / (p.chi + 2.0));
                Some((power * growth.powf(p.chi + 1.0), 0.0, joint.phi_max() * growth))
            }
            _ => None,
        };
        for (power, dirac, phi_max) in same_knee.into_iter().chain(without) {
            let f_s = (power * c + dirac) * phi_max;
            let other = Parameters { k_t: power + dirac, f_s, beta: dirac / power, ..p };
            let Ok(own) = chart.coordinates(&other) else { continue };
            let mut x = near.to_vec();
            self.free.iter().filter(|j| **j < own.len()).for_each(|&j| x[j] = own[j]);
            x[self.coordinate] = at;
            all.push(x);
        }
        all
    }

    /// On the straight line through the two points nearest to `at`, next to the minimum on its tangent; inside the bounds.
    fn ahead(&self, at: f64) -> Vec<f64> {
        let own = (self.minimum.x[self.coordinate], &self.minimum.x);
        let mut all: Vec<(f64, &Vec<f64>)> =
            self.points.iter().map(|p| (p.0, &p.2)).chain(std::iter::once(own)).collect();
        all.sort_by(|a, b| (a.0 - at).abs().total_cmp(&(b.0 - at).abs()));
        let (bounds, (place, near)) = (self.task.bounds(), all[0]);
        let far = all
            .iter()
            .find(|p| p.0 != place)
            .filter(|p| (at - p.0).abs() < FARTHEST_AHEAD * (place - p.0).abs());
        let mut x = near.clone();
        for (k, &j) in self.free.iter().enumerate() {
            let slope = match (far, &self.tangent) {
                (Some(far), _) => (near[j] - far.1[j]) / (place - far.0),
                (None, Some(tangent)) => tangent[k],
                (None, None) => 0.0,
            };
            x[j] = (near[j] + slope * (at - place)).clamp(bounds[j].0, bounds[j].1);
        }
        x[self.coordinate] = at;
        x
    }

    /// All coordinates of the point nearest to `at`.
    fn nearest(&self, at: f64) -> Vec<f64> {
        let own = (self.minimum.x[self.coordinate], 0.0, self.minimum.x.clone());
        let all = self.points.iter().chain(std::iter::once(&own));
        let nearest = all.min_by(|a, b| (a.0 - at).abs().total_cmp(&(b.0 - at).abs()));
        nearest.map_or_else(|| self.minimum.x.clone(), |p| p.2.clone())
    }

    /// Walks outwards until the deviance passes the limit, then to the limit itself.
    fn go(&mut self, direction: f64) -> Result<End, Minimum> {
        let start = self.minimum.x[self.coordinate];
        let (low, high) = self.task.bounds()[self.coordinate];
        let bound = if direction < 0.0 { low } else { high };
        let mut step = self.first_step();
        let mut inside = (start, 0.0);
        for _ in 0..OUTWARDS {
            let wanted = inside.0 + direction * step;
            let at = if (wanted - bound) * direction >= 0.0 { bound } else { wanted };
            let deviance = self.deviance(at)?.unwrap_or(f64::INFINITY);
            if deviance >= self.scale.limit {
                return Ok(self.close_in(inside, (at, deviance))?.map_or(End::Open, End::Closed));
            }
            if at == bound || (at - start).abs() > FARTHEST || self.all_of_stiffness() {
                return Ok(End::Open);
            }
            // Where the root of the deviance grows evenly, a little beyond the limit.
            let growth = (self.scale.limit / deviance.max(1e-3 * self.scale.limit)).sqrt();
            step = (1.1 * growth * (at - start).abs() - (at - start).abs()).clamp(0.3 * step, 4.0 * step);
            if self.unseen {
                step = step.min(CLOSE);
            }
            inside = (at, deviance);
        }
        Ok(End::Open)
    }

    /// Whether the farthest point inside needs nearly all stiffness to be the joint's: the end is not the record's then.
    fn all_of_stiffness(&self) -> bool {
        let inside = self.points.iter().filter(|p| p.1 < self.scale.limit);
        let start = self.minimum.x[self.coordinate];
        let farthest = inside.max_by(|a, b| (a.0 - start).abs().total_cmp(&(b.0 - start).abs()));
        farthest.is_some_and(|(_, _, x)| {
            let p = self.task.chart.parameters(x);
            p.k_t > MOST_JOINT * (std::f64::consts::TAU * p.frequency).powi(2)
        })
    }

    /// From a point inside and one outside to the limit: by the line through the roots of the deviances, by halves
    /// where they are too far apart for that. None where the way ends not at the limit but at the edge of the model.
    fn close_in(&mut self, mut inside: (f64, f64), mut outside: (f64, f64)) -> Result<Option<f64>, Minimum> {
        let (root, start) = (self.scale.limit.sqrt(), self.minimum.x[self.coordinate]);
        let share = |inside: f64, outside: f64| {
            let (a, b) = (inside.sqrt(), outside.sqrt());
            if b > FAR_OUTSIDE * root { 0.5 } else { ((root - a) / (b - a)).clamp(0.05, 0.95) }
        };
        for _ in 0..INWARDS {
            let near = |d: f64| (d.sqrt() - root).abs() <= PRECISION * root;
            let narrow = (outside.0 - inside.0).abs() <= PRECISION * (inside.0 - start).abs();
            if near(inside.1) || near(outside.1) || narrow {
                break;
            }
            let at = inside.0 + share(inside.1, outside.1) * (outside.0 - inside.0);
            let deviance = self.deviance(at)?.unwrap_or(f64::INFINITY);
            if deviance < self.scale.limit { inside = (at, deviance) } else { outside = (at, deviance) }
        }
        let closed = outside.1.is_finite() && !self.all_of_stiffness();
        Ok(closed.then(|| inside.0 + share(inside.1, outside.1) * (outside.0 - inside.0)))
    }

    /// Student's t times the standard deviation by curvature; to where φ_max is the largest amplitude when it is unseen.
    fn first_step(&mut self) -> f64 {
        if self.unseen {
            let chi = self.task.chart.parameters(&self.minimum.x).chi;
            let power = if self.parameter == Parameter::KT { chi + 1.0 } else { chi + 2.0 };
            return power * KNEE_UNSEEN.ln();
        }
        let free: Vec<usize> = self.free.iter().copied().chain([self.coordinate]).collect();
        let place = Some(free.len() - 1);
        let search = self.task.search(free, (0, 0.0));
        let (task, work) = (self.task, &mut self.work);
        let mut residuals = |x: &[f64], out: &mut [f64]| task.residuals(x, out, work);
        let mut r = vec![0.0; task.count()];
        residuals(&self.minimum.x, &mut r);
        let jacobian = search.jacobian(&mut residuals, &self.minimum.x, &r);
        self.tangent = jacobian.as_ref().and_then(following);
        let deviation = jacobian.and_then(|j| {
            let inverse = j.qr().r().try_inverse()?;
            Some(inverse.row(place?).norm())
        });
        let step = deviation.map(|d| d * (self.scale.variance * self.scale.limit).sqrt());
        step.filter(|s| s.is_finite()).map_or(FIRST_STEP, |s| s.clamp(1e-9, 5.0 * FIRST_STEP))
    }
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
