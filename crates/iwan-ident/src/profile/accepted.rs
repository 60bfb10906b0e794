//! The points that measurements accept: at each knee the best of all others, how far these can move there, and the intervals that they
//! leave together.

use nalgebra::{DMatrix, DVector};

use super::deviance::Scale;
use super::ground::Ground;
use super::outcome::{Profile, ProfilePoint};
use super::walk::{End, Walk};
use crate::parameters::{COUNT, Parameter};
use crate::search::{Chart, Minimum};

/// Half step of the differences of a parameter with respect to the coordinates: these are closed forms, and central differences are
/// best near the cube root of rounding.
const STEP: f64 = 1e-5;

/// A ground whose first coordinates are those of the six parameters.
pub(crate) trait Charted: Ground {
    /// What the coordinates mean.
    fn chart(&self) -> &Chart;

    /// The coordinates on which the sum of squares depends smoothly at `x`: not the knee.
    fn smooth_at(&self, x: &[f64]) -> Vec<usize>;
}

/// A point within the limit, with what is left of the deviance there.
#[derive(Debug, Clone)]
pub(crate) struct Accepted {
    pub(crate) minimum: Minimum,
    deviance: f64,
    /// Inverse of the triangular factor of the residuals' derivatives with respect to the smooth coordinates, and these.
    spread: Option<DMatrix<f64>>,
    smooth: Vec<usize>,
}

/// All points within the limit, and whether they reach the ends of the range of knees.
#[derive(Debug)]
pub(crate) struct Region {
    points: Vec<Accepted>,
    /// The largest knee that was tried is accepted: an upper end is not told.
    to_largest_knee: bool,
    /// The smallest one is.
    to_smallest_knee: bool,
}

impl Region {
    /// Of the points found along all knees: `knee` is their coordinate with its range, where it is sought.
    ///
    /// # Errors
    /// A better minimum.
    pub(crate) fn of<G: Charted>(
        ground: &G,
        mut found: Vec<Minimum>,
        knee: Option<(usize, [f64; 2])>,
        scale: &Scale,
        work: &mut G::Work,
    ) -> Result<Self, Minimum> {
        let best = found.iter().min_by(|a, b| a.cost.total_cmp(&b.cost));
        if let Some(better) = best.filter(|m| scale.rise(m) < scale.better) {
            return Err(better.clone());
        }
        found.retain(|m| scale.rise(m) < scale.limit);
        let reaches = |end: fn(f64, [f64; 2]) -> bool| {
            knee.is_some_and(|(knee, range)| found.iter().any(|m| end(m.x[knee], range)))
        };
        let to_largest_knee = reaches(|at, [_, high]| at >= high);
        let to_smallest_knee = reaches(|at, [low, _]| at <= low);
        let points = found.into_iter().map(|m| Accepted::new(ground, m, scale, work)).collect();
        Ok(Self { points, to_largest_knee, to_smallest_knee })
    }

    /// The profile of a parameter with such a best value, which its interval contains; `end` walks to an end of its interval, downwards with -1 and
    /// upwards with 1, and adds the points that it meets. `slips`: whether macro-slip is clearly seen.
    pub(crate) fn profile<G: Charted>(
        &self,
        ground: &G,
        value: f64,
        (parameter, held): (Parameter, bool),
        slips: bool,
        end: &dyn Fn(f64, &mut Vec<ProfilePoint>) -> Option<f64>,
    ) -> Profile {
        let point = |p: &Accepted| ProfilePoint { value: p.value(ground, parameter), deviance: p.deviance };
        let mut points: Vec<ProfilePoint> = self.points.iter().map(point).collect();
        let mut reach = |low: bool, direction: f64| {
            (!held && self.tells(parameter, low, slips)).then(|| end(direction, &mut points)).flatten()
        };
        let low = reach(true, -1.0).map(|low| low.min(value));
        let high = reach(false, 1.0).map(|high| high.max(value));
        points.sort_by(|a, b| a.value.total_cmp(&b.value).then(a.deviance.total_cmp(&b.deviance)));
        points.dedup_by(|later, kept| later.value == kept.value);
        Profile { parameter, value, low, high, points, held }
    }

    /// Whether this end of a parameter can be told at all.
    fn tells(&self, parameter: Parameter, low: bool, slips: bool) -> bool {
        match parameter {
            Parameter::KT | Parameter::FS if low => !self.to_smallest_knee,
            Parameter::KT | Parameter::FS => slips && !self.to_largest_knee,
            Parameter::Beta => slips && !self.to_largest_knee && !self.to_smallest_knee,
            _ => true,
        }
    }

    /// The point from which a parameter reaches farthest in a direction.
    pub(crate) fn farthest<G: Charted>(
        &self,
        ground: &G,
        scale: &Scale,
        parameter: Parameter,
        direction: f64,
    ) -> Option<&Minimum> {
        let reached = |p: &Accepted| {
            direction * scaled(parameter, p.value(ground, parameter)) + p.reach(ground, scale, parameter)
        };
        let farthest = self.points.iter().max_by(|a, b| reached(a).total_cmp(&reached(b)))?;
        Some(&farthest.minimum)
    }

    /// The accepted points, those first that have the least against a value of a parameter in the linearised model.
    pub(crate) fn likeliest_at<G: Charted>(
        &self,
        ground: &G,
        scale: &Scale,
        parameter: Parameter,
        value: f64,
    ) -> Vec<&Minimum> {
        let against = |p: &Accepted| p.deviance_at(ground, scale, parameter, value);
        let mut points: Vec<(f64, &Minimum)> = self.points.iter().map(|p| (against(p), &p.minimum)).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        points.into_iter().map(|(_, minimum)| minimum).collect()
    }

    /// The end of an interval where a walk ends at `value`: no accepted point lies outside.
    pub(crate) fn outermost<G: Charted>(
        &self,
        ground: &G,
        parameter: Parameter,
        direction: f64,
        value: f64,
    ) -> f64 {
        let all = self.points.iter().map(|p| p.value(ground, parameter));
        all.fold(value, |a, b| if direction < 0.0 { a.min(b) } else { a.max(b) })
    }
}

impl<W: Charted> Walk<'_, W> {
    /// The coordinates where the walk ends, the end of an interval of its parameter; none where it is open. The points it meets are added to `points`.
    pub(crate) fn end(
        mut self,
        parameter: Parameter,
        direction: f64,
        points: &mut Vec<ProfilePoint>,
    ) -> Option<Vec<f64>> {
        let chart = self.task.chart();
        let value = |x: &[f64]| chart.parameters(x).get(parameter);
        self.stiffness_ends = matches!(parameter, Parameter::KT | Parameter::FS | Parameter::Beta);
        let found = self.go(direction).unwrap_or(End::Open);
        points.extend(
            self.visited.iter().map(|v| ProfilePoint { value: value(&v.minimum.x), deviance: v.deviance }),
        );
        let End::Closed(at) = found else { return None };
        let mut x = self.nearest(at);
        x[self.coordinate] = at;
        Some(x)
    }
}

impl Accepted {
    fn new<G: Charted>(ground: &G, minimum: Minimum, scale: &Scale, work: &mut G::Work) -> Self {
        let smooth = ground.smooth_at(&minimum.x);
        let jacobian = ground.jacobian(&minimum.x, smooth.clone(), work);
        let spread = jacobian.and_then(|j| j.qr().r().try_inverse());
        Self { deviance: scale.rise(&minimum).max(0.0), minimum, spread, smooth }
    }

    /// How far a parameter (its logarithm where it has one) can go from here in the linearised model before the limit is reached.
    fn reach<G: Charted>(&self, ground: &G, scale: &Scale, parameter: Parameter) -> f64 {
        let left = (scale.limit - self.deviance).max(0.0);
        self.deviation(ground, scale, parameter) * left.sqrt()
    }

    /// The deviance in the linearised model where a parameter has a value.
    fn deviance_at<G: Charted>(&self, ground: &G, scale: &Scale, parameter: Parameter, value: f64) -> f64 {
        let away = scaled(parameter, value) - scaled(parameter, self.value(ground, parameter));
        let deviation = self.deviation(ground, scale, parameter).max(f64::MIN_POSITIVE);
        self.deviance + (away / deviation).powi(2)
    }

    /// Standard deviation of a parameter (its logarithm where it has one) in the linearised model.
    fn deviation<G: Charted>(&self, ground: &G, scale: &Scale, parameter: Parameter) -> f64 {
        let Some(spread) = &self.spread else { return 0.0 };
        let slope = |j: &usize| {
            if *j >= COUNT {
                return 0.0;
            }
            let at = |by: f64| {
                let mut x = self.minimum.x.clone();
                x[*j] += by;
                scaled(parameter, ground.chart().parameters(&x).get(parameter))
            };
            (at(STEP) - at(-STEP)) / (2.0 * STEP)
        };
        let slopes = DVector::from_iterator(self.smooth.len(), self.smooth.iter().map(slope));
        (spread.transpose() * slopes).norm() * scale.variance.sqrt()
    }

    fn value<G: Charted>(&self, ground: &G, parameter: Parameter) -> f64 {
        ground.chart().parameters(&self.minimum.x).get(parameter)
    }
}

/// The scale on which intervals are sought: logarithms of what is positive.
fn scaled(parameter: Parameter, value: f64) -> f64 {
    match parameter {
        Parameter::DampingRatio | Parameter::Chi => value,
        Parameter::Beta => value / (1.0 + value),
        _ => value.ln(),
    }
}
