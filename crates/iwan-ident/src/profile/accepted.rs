//! The region: the points that measurements accept, namely the best fit at each knee, how far parameters can move from there, and the intervals that
//! all points leave together.

use iwan_machine::threads::{at_once, in_parallel};
use nalgebra::{DMatrix, DVector};

use super::deviance::Scale;
use super::ground::Ground;
use super::outcome::{Profile, ProfilePoint};
use super::walk::{End, Walk};
use crate::parameters::{COUNT, Parameter};
use crate::search::{Chart, Minimum};

/// Half step of the differences of a parameter with respect to the coordinates. These are closed forms, for which central differences are best near
/// the cube root of rounding.
const STEP: f64 = 1e-5;

/// A ground (sum of squares) whose first coordinates are those of the six parameters.
pub(crate) trait Charted: Ground {
    /// The meaning of the coordinates.
    fn chart(&self) -> &Chart;

    /// The coordinates on which the sum of squares depends smoothly at `x`: all that are sought but the knee.
    fn smooth_at(&self, x: &[f64]) -> Vec<usize>;
}

/// A point within the limit, with its deviance.
#[derive(Debug, Clone)]
pub(crate) struct Accepted {
    pub(crate) minimum: Minimum,
    deviance: f64,
    /// Inverse of the triangular factor of the residuals' derivatives with respect to the smooth coordinates, and the indices of these.
    spread: Option<DMatrix<f64>>,
    smooth: Vec<usize>,
}

/// All points within the limit, and whether they reach the ends of the range of knees.
#[derive(Debug)]
pub(crate) struct Region {
    points: Vec<Accepted>,
    /// Whether the largest knee that was tried is accepted: K_T and F_S then have no upper end, β has no end at all.
    to_largest_knee: bool,
    /// Whether the smallest knee that was tried is accepted: K_T and F_S then have no lower end, β has no end at all.
    to_smallest_knee: bool,
}

impl Region {
    /// The region of the points `found` along all knees; `knee` is the index of the knee among the coordinates and its range, where it is sought.
    ///
    /// # Errors
    /// A better minimum, where one of the points has a deviance below [`Scale::better`].
    pub(crate) fn of<G: Charted + Sync>(
        ground: &G,
        mut found: Vec<Minimum>,
        knee: Option<(usize, [f64; 2])>,
        scale: &Scale,
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
        let point = |m: &Minimum| Accepted::new(ground, m.clone(), scale, &mut G::Work::default());
        let points = in_parallel(&found, at_once(), &point);
        Ok(Self { points, to_largest_knee, to_smallest_knee })
    }

    /// The profile of a parameter with the best value `value`, which the interval contains. `end` walks to an end of the interval, downwards with -1
    /// and upwards with 1, and adds the points that it meets. `slips` says whether macro-slip is clearly seen.
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

    /// Whether the records can tell this end of a parameter (the lower one with `low`) at all.
    fn tells(&self, parameter: Parameter, low: bool, slips: bool) -> bool {
        match parameter {
            Parameter::KT | Parameter::FS if low => !self.to_smallest_knee,
            Parameter::KT | Parameter::FS => slips && !self.to_largest_knee,
            Parameter::Beta => slips && !self.to_largest_knee && !self.to_smallest_knee,
            _ => true,
        }
    }

    /// The accepted point from which a parameter reaches farthest in a direction, in the linearised model.
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

    /// The accepted points with the deviances that they have in the linearised model where a parameter has the given value, the least first.
    pub(crate) fn likeliest_at<G: Charted>(
        &self,
        ground: &G,
        scale: &Scale,
        parameter: Parameter,
        value: f64,
    ) -> Vec<(f64, &Accepted)> {
        let against = |p: &Accepted| p.deviance_at(ground, scale, parameter, value);
        let mut points: Vec<(f64, &Accepted)> = self.points.iter().map(|p| (against(p), p)).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        points
    }

    /// The end of an interval where a walk ends at `value`, moved outwards so that no accepted point lies outside.
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
    /// All coordinates at the end of the walk, which is an end of its parameter's interval; none where it is open. The points that the walk meets are
    /// added to `points`.
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

    /// How far a parameter, on the scale of `scaled`, can go from here in the linearised model before the limit is reached.
    fn reach<G: Charted>(&self, ground: &G, scale: &Scale, parameter: Parameter) -> f64 {
        let left = (scale.limit - self.deviance).max(0.0);
        self.deviation(ground, scale, parameter) * left.sqrt()
    }

    /// The deviance in the linearised model where a parameter has the given value.
    fn deviance_at<G: Charted>(&self, ground: &G, scale: &Scale, parameter: Parameter, value: f64) -> f64 {
        let away = scaled(parameter, value) - scaled(parameter, self.value(ground, parameter));
        let deviation = self.deviation(ground, scale, parameter).max(f64::MIN_POSITIVE);
        self.deviance + (away / deviation).powi(2)
    }

    /// Standard deviation of a parameter, on the scale of `scaled`, in the linearised model.
    fn deviation<G: Charted>(&self, ground: &G, scale: &Scale, parameter: Parameter) -> f64 {
        let Some(spread) = &self.spread else { return 0.0 };
        spread.tr_mul(&self.slopes(ground, parameter)).norm() * scale.variance.sqrt()
    }

    /// The coordinates at which the linearised model has the least sum of squares where a parameter has the given value; those of the point itself where the parameter hangs on none of them.
    pub(super) fn towards<G: Charted>(&self, ground: &G, parameter: Parameter, value: f64) -> Vec<f64> {
        let mut x = self.minimum.x.clone();
        let away = scaled(parameter, value) - scaled(parameter, self.value(ground, parameter));
        let Some(spread) = &self.spread else { return x };
        let told = spread.tr_mul(&self.slopes(ground, parameter));
        let square = told.norm_squared();
        if square > 0.0 {
            let (step, bounds) = (spread * told * (away / square), ground.bounds());
            for (j, step) in self.smooth.iter().zip(&step) {
                x[*j] = (x[*j] + step).clamp(bounds[*j].0, bounds[*j].1);
            }
        }
        x
    }

    /// Derivatives of a parameter, on the scale of `scaled`, with respect to the smooth coordinates.
    fn slopes<G: Charted>(&self, ground: &G, parameter: Parameter) -> DVector<f64> {
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
        DVector::from_iterator(self.smooth.len(), self.smooth.iter().map(slope))
    }

    fn value<G: Charted>(&self, ground: &G, parameter: Parameter) -> f64 {
        ground.chart().parameters(&self.minimum.x).get(parameter)
    }
}

/// A parameter on the scale on which its interval is sought: as it is, β as β/(1+β), and the logarithm of what is positive.
fn scaled(parameter: Parameter, value: f64) -> f64 {
    match parameter {
        Parameter::DampingRatio | Parameter::Chi => value,
        Parameter::Beta => value / (1.0 + value),
        _ => value.ln(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::search::{CHI, DAMPING, FREQUENCY, SOFTENING};

    /// Residuals that are linear in the coordinates, with the least sum of squares at `best`.
    struct Plane {
        chart: Chart,
        best: [f64; COUNT],
        slopes: DMatrix<f64>,
    }

    const SMOOTH: [usize; 4] = [FREQUENCY, DAMPING, SOFTENING, CHI];

    impl Ground for Plane {
        type Work = ();

        fn bounds(&self) -> Vec<(f64, f64)> {
            Chart::bounds().to_vec()
        }

        fn cost(&self, x: &[f64], (): &mut ()) -> Option<f64> {
            let away = DVector::from_iterator(SMOOTH.len(), SMOOTH.iter().map(|j| x[*j] - self.best[*j]));
            Some((&self.slopes * away).norm_squared())
        }

        fn minimise(&self, _: &[f64], _: Vec<usize>, _: f64, (): &mut ()) -> Option<Minimum> {
            None
        }

        fn jacobian(&self, _: &[f64], _: Vec<usize>, (): &mut ()) -> Option<DMatrix<f64>> {
            Some(self.slopes.clone())
        }

        fn is_at_edge(&self, _: &[f64]) -> bool {
            false
        }
    }

    impl Charted for Plane {
        fn chart(&self) -> &Chart {
            &self.chart
        }

        fn smooth_at(&self, _: &[f64]) -> Vec<usize> {
            SMOOTH.to_vec()
        }
    }

    /// K_T hangs on frequency, softening and χ alike. The point towards a value of it has that value, the deviance that is foretold, and no neighbour with the same value that lies lower.
    #[test]
    fn the_point_towards_a_value_lies_lowest_among_those_that_have_it() {
        let chart = Chart::holding(&[], 1e-4);
        let p = crate::parameters::Parameters {
            frequency: 124.0,
            damping_ratio: 2e-3,
            k_t: 4.45e4,
            f_s: 20.0,
            chi: -0.3,
            beta: 0.4,
        };
        let best = chart.coordinates(&p).unwrap();
        // Columns that are far from orthogonal, with coordinates of unlike spread.
        let slopes = DMatrix::from_fn(9, 4, |i, j| {
            (0.7 * (i * (j + 2)) as f64).sin() * 10.0_f64.powi([4, 3, 2, 1][j]) + 3.0
        });
        let plane = Plane { chart, best, slopes };
        let cost = |x: &[f64]| plane.cost(x, &mut ()).unwrap();
        let value = |x: &[f64]| plane.chart.parameters(x).get(Parameter::KT);
        let scale = Scale::about(0.0, 1.0, 100.0);
        let minimum = Minimum { x: best.to_vec(), cost: 0.0, converged: true };
        let accepted = Accepted::new(&plane, minimum, &scale, &mut ());
        let wanted = 1.001 * p.k_t;
        let x = accepted.towards(&plane, Parameter::KT, wanted);
        assert!((value(&x) / wanted - 1.0).abs() < 1e-5, "{}", value(&x) / wanted);
        let foretold = accepted.deviance_at(&plane, &scale, Parameter::KT, wanted);
        assert!((cost(&x) / foretold - 1.0).abs() < 1e-6, "{} {foretold}", cost(&x));
        // Steps along each coordinate, with the softening brought to where K_T is as before.
        let slope = |j: usize| {
            let mut moved = x.clone();
            moved[j] += STEP;
            (value(&moved) - value(&x)) / STEP
        };
        for j in [FREQUENCY, DAMPING, CHI] {
            for step in [-1e-5, 1e-5] {
                let mut moved = x.clone();
                moved[j] += step;
                moved[SOFTENING] -= step * slope(j) / slope(SOFTENING);
                assert!(cost(&moved) > cost(&x), "{j} {step}: {} {}", cost(&moved), cost(&x));
            }
        }
        // What does not move K_T stays.
        let knee = crate::search::KNEE;
        assert_eq!(x[knee], best[knee]);
    }
}
