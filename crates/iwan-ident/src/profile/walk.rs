//! A walk from the minimum along one coordinate, all others following, to where the records contradict the coordinate's value.

use super::deviance::Scale;
use super::ground::Ground;
use crate::search::{Minimum, following};

/// Distance from the best value, in coordinates (logarithms, mostly), from which on an interval is open: a factor of 1,100 either way, beyond which
/// no engineer would call the parameter known.
const FARTHEST: f64 = 7.0;
/// First step where the curvature says nothing: a tenth of a logarithm. From there steps grow by up to four times.
const FIRST_STEP: f64 = 0.1;
/// How far a line through two points is followed, in distances between them: beyond, the line is a worse beginning for a search than the nearest
/// point itself. A judgement; a bad beginning costs time, not the result.
const FARTHEST_AHEAD: f64 = 5.0;
/// Most steps outwards; the end is open if the walk is still inside the limit after them.
const OUTWARDS: usize = 24;
/// Most rounds that bring an end to its precision: halving alone would bring the end to 2^-16 of the last step. Where they are spent the end is where
/// the line through the last two points puts it.
const INWARDS: usize = 16;
/// Ratio of roots of deviances, outside point over limit, above which a straight line between the two points is no use: halving closes in faster
/// there.
const FAR_OUTSIDE: f64 = 4.0;
/// Factor on either side of the limit by which a deviance jumps where a search has lost the valley; along a valley that is followed the deviance
/// changes by less between points so near. A judgement.
const JUMP: f64 = 1.5;
/// Most times that a walk sets out anew from where its search lost the valley. Each time gets some steps farther; when they are spent the end stands
/// where the valley was lost last.
const ANEW: usize = 8;
/// Relative precision of an end's distance, as the root of the deviance: half a per cent of an interval's half width, below what anyone reads off it.
const PRECISION: f64 = 5e-3;
/// Largest product of the distances of two points, inside and outside, from the limit (as roots of deviances, over the limit's) at which the line between
/// them puts the end to [`PRECISION`]. A line is off by half that product times the curvature of the root of the deviance over distance, which was at
/// most 0.4 in walks of coupled fits: points at 0.939 and 1.211 put the end where the root of the deviance was 0.995.
const STRAIGHT: f64 = 0.025;

/// A walk along one coordinate.
pub(crate) struct Walk<'a, G: Ground> {
    pub(super) task: &'a G,
    pub(super) coordinate: usize,
    /// The coordinates that follow.
    pub(super) free: Vec<usize>,
    /// The minimum at which the walk begins.
    pub(super) minimum: &'a Minimum,
    pub(super) scale: &'a Scale,
    /// Whether an end is open where the joint has nearly all stiffness: the model then makes the end, not the records.
    pub(crate) stiffness_ends: bool,
    /// Change of the coordinates that follow per unit of the walk's coordinate, next to the minimum.
    tangent: Option<Vec<f64>>,
    work: G::Work,
    /// The points that the walk has visited, in the order of time.
    pub(crate) visited: Vec<Visited>,
}

/// A point of a walk.
pub(crate) struct Visited {
    /// Value of the coordinate.
    pub(crate) at: f64,
    /// The least sum of squares there.
    pub(crate) minimum: Minimum,
    pub(crate) deviance: f64,
}

/// A value of the walk's coordinate, and the deviance there.
#[derive(Debug, Clone, Copy)]
struct Place {
    at: f64,
    deviance: f64,
}

/// The end of a walk: open, or closed at a value of its coordinate.
pub(crate) enum End {
    Open,
    Closed(f64),
}

impl<'a, G: Ground> Walk<'a, G> {
    pub(crate) fn new(
        task: &'a G,
        coordinate: usize,
        free: Vec<usize>,
        minimum: &'a Minimum,
        scale: &'a Scale,
    ) -> Self {
        let work = G::Work::default();
        Self {
            task,
            coordinate,
            free,
            minimum,
            scale,
            stiffness_ends: false,
            tangent: None,
            work,
            visited: vec![],
        }
    }

    /// Deviance with the coordinate held at `at`; none where there is no model, and as an error a better minimum where one is found.
    ///
    /// Searches begin at the nearest known point and on the line through the two nearest ones. The beginning with the lower sum of squares is tried
    /// first, the other one only where the first search says that the records forbid the value.
    fn deviance(&mut self, at: f64) -> Result<Option<f64>, Minimum> {
        let mut plain = self.nearest(at);
        plain[self.coordinate] = at;
        let beginnings = [plain, self.ahead(at)];
        let mut ways: Vec<(f64, Vec<f64>)> =
            beginnings.into_iter().filter_map(|x| Some((self.task.cost(&x, &mut self.work)?, x))).collect();
        ways.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut best: Option<Minimum> = None;
        for (_, x) in ways {
            let found = self.task.minimise(&x, self.free.clone(), self.scale.tolerance(), &mut self.work);
            best = best.into_iter().chain(found).min_by(|a, b| a.cost.total_cmp(&b.cost));
            if best.as_ref().is_some_and(|b| self.scale.rise(b) < self.scale.limit) {
                break;
            }
        }
        let Some(mut found) = best else { return Ok(None) };
        if self.scale.rise(&found) >= self.scale.limit {
            let deepened =
                self.task.deepened(&found, self.free.clone(), self.scale.tolerance(), &mut self.work);
            found = deepened.filter(|d| d.cost < found.cost).unwrap_or(found);
        }
        let deviance = self.scale.rise(&found);
        if deviance < self.scale.better {
            return Err(found);
        }
        self.visited.push(Visited {
            at,
            minimum: Minimum { converged: true, ..found },
            deviance: deviance.max(0.0),
        });
        Ok(Some(deviance.max(0.0)))
    }

    /// A point at `at` on the straight line through the two points nearest to it, or, next to the minimum, on the minimum's tangent; inside the
    /// bounds.
    fn ahead(&self, at: f64) -> Vec<f64> {
        let own = (self.minimum.x[self.coordinate], &self.minimum.x);
        let mut all: Vec<(f64, &Vec<f64>)> =
            self.visited.iter().map(|p| (p.at, &p.minimum.x)).chain(std::iter::once(own)).collect();
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
    pub(crate) fn nearest(&self, at: f64) -> Vec<f64> {
        let own = (self.minimum.x[self.coordinate], &self.minimum.x);
        let all = self.visited.iter().map(|p| (p.at, &p.minimum.x)).chain(std::iter::once(own));
        let nearest = all.min_by(|a, b| (a.0 - at).abs().total_cmp(&(b.0 - at).abs()));
        nearest.map_or_else(|| self.minimum.x.clone(), |p| p.1.clone())
    }

    /// Walks outwards until the deviance passes the limit, then closes in on the limit. Where the deviance jumps there, from far inside the limit to
    /// far outside, the search has lost a valley that is narrow and bent: the walk sets out anew from the last point inside, by shorter steps.
    pub(crate) fn go(&mut self, direction: f64) -> Result<End, Minimum> {
        let start = self.minimum.x[self.coordinate];
        let mut step = self.first_step();
        let mut inside = Place { at: start, deviance: self.scale.rise(self.minimum).max(0.0) };
        let mut anew = ANEW;
        loop {
            let Some([last, outside]) = self.outwards(inside, direction, step)? else { return Ok(End::Open) };
            let Some([last, outside]) = self.close_in(last, outside)? else { return Ok(End::Open) };
            let lost = outside.deviance.is_finite() && self.jumps(last, outside);
            if !lost || last.at == inside.at || anew == 0 {
                return Ok(End::Closed(self.between(last, outside)));
            }
            (step, inside, anew) = ((outside.at - last.at).abs(), last, anew - 1);
        }
    }

    /// The last point inside the limit and the first one outside, walking from the point `inside` with a first step; none where the way is open.
    fn outwards(
        &mut self,
        mut inside: Place,
        direction: f64,
        mut step: f64,
    ) -> Result<Option<[Place; 2]>, Minimum> {
        let start = self.minimum.x[self.coordinate];
        let (low, high) = self.task.bounds()[self.coordinate];
        let bound = if direction < 0.0 { low } else { high };
        for _ in 0..OUTWARDS {
            let wanted = inside.at + direction * step;
            let at = if (wanted - bound) * direction >= 0.0 { bound } else { wanted };
            let deviance = self.deviance(at)?.unwrap_or(f64::INFINITY);
            if deviance >= self.scale.limit {
                return Ok(Some([inside, Place { at, deviance }]));
            }
            if at == bound
                || (at - start).abs() > FARTHEST
                || (self.stiffness_ends && self.all_of_stiffness())
            {
                return Ok(None);
            }
            // The next step leads a little beyond the limit, if the root of the deviance grows evenly with the distance.
            let growth = (self.scale.limit / deviance.max(1e-3 * self.scale.limit)).sqrt();
            step = (1.1 * growth * (at - start).abs() - (at - start).abs()).clamp(0.3 * step, 4.0 * step);
            inside = Place { at, deviance };
        }
        Ok(None)
    }

    /// Whether the deviance jumps over the limit between a point inside and one outside.
    fn jumps(&self, inside: Place, outside: Place) -> bool {
        inside.deviance < self.scale.limit / JUMP && outside.deviance > self.scale.limit * JUMP
    }

    /// Where the limit lies between a point inside (0) and one outside (1): by the line through the roots of their deviances, or halfway where these
    /// are too far apart for a line.
    fn share(&self, inside: Place, outside: Place) -> f64 {
        let root = self.scale.limit.sqrt();
        let (a, b) = (inside.deviance.sqrt(), outside.deviance.sqrt());
        if b > FAR_OUTSIDE * root { 0.5 } else { ((root - a) / (b - a)).clamp(0.0, 1.0) }
    }

    /// The end of an interval between its last point inside and the first one outside, or the point inside where there is no model beyond.
    fn between(&self, inside: Place, outside: Place) -> f64 {
        let share = if outside.deviance.is_finite() { self.share(inside, outside) } else { 0.0 };
        inside.at + share * (outside.at - inside.at)
    }

    /// Whether at the farthest point inside nearly all stiffness is the joint's: the model then makes the end, not the record.
    fn all_of_stiffness(&self) -> bool {
        let inside = self.visited.iter().filter(|p| p.deviance < self.scale.limit);
        let start = self.minimum.x[self.coordinate];
        let farthest = inside.max_by(|a, b| (a.at - start).abs().total_cmp(&(b.at - start).abs()));
        farthest.is_some_and(|farthest| self.task.is_at_edge(&farthest.minimum.x))
    }

    /// From a point inside the limit and one outside to two that are next to each other or to the limit. None where the way ends at the edge of the
    /// model and such an end is open.
    fn close_in(&mut self, mut inside: Place, mut outside: Place) -> Result<Option<[Place; 2]>, Minimum> {
        let (root, start) = (self.scale.limit.sqrt(), self.minimum.x[self.coordinate]);
        for _ in 0..INWARDS {
            let near = |d: f64| (d.sqrt() - root).abs() <= PRECISION * root;
            let narrow = (outside.at - inside.at).abs() <= PRECISION * (inside.at - start).abs();
            let apart = (root - inside.deviance.sqrt()) * (outside.deviance.sqrt() - root);
            let straight = self.scale.even && apart <= STRAIGHT * root * root;
            if near(inside.deviance) || near(outside.deviance) || narrow || straight {
                break;
            }
            // Away from both ends, so that each round closes in whatever the line says.
            let share = self.share(inside, outside).clamp(0.05, 0.95);
            let at = inside.at + share * (outside.at - inside.at);
            let deviance = self.deviance(at)?.unwrap_or(f64::INFINITY);
            let place = Place { at, deviance };
            if deviance < self.scale.limit { inside = place } else { outside = place }
        }
        // Where there is no model beyond, the model itself ends the interval: this says nothing about the joint and its slip force.
        let ends_model = !outside.deviance.is_finite() || self.all_of_stiffness();
        Ok((!self.stiffness_ends || !ends_model).then_some([inside, outside]))
    }

    /// First step: Student's t times the standard deviation of the coordinate by the curvature at the minimum. The tangent is computed with it.
    fn first_step(&mut self) -> f64 {
        let free: Vec<usize> = self.free.iter().copied().chain([self.coordinate]).collect();
        let place = Some(free.len() - 1);
        let jacobian = self.task.jacobian(&self.minimum.x, free, &mut self.work);
        self.tangent = jacobian.as_ref().and_then(following);
        let deviation = jacobian.and_then(|j| {
            let inverse = j.qr().r().try_inverse()?;
            Some(inverse.row(place?).norm())
        });
        let left = (self.scale.limit - self.scale.rise(self.minimum)).clamp(0.01, self.scale.limit);
        let step = deviation.map(|d| d * (self.scale.variance * left).sqrt());
        step.filter(|s| s.is_finite()).map_or(FIRST_STEP, |s| s.clamp(1e-9, 5.0 * FIRST_STEP))
    }
}
