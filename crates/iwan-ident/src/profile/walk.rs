//! A walk from the minimum along one coordinate, to where the records contradict.

use super::deviance::Scale;
use super::ground::Ground;
use crate::search::{Minimum, following};

/// An interval that reaches this far from its value, in coordinates (logarithms, mostly), is open: a factor of 1,100 either
/// way, beyond which no engineer would call the parameter known.
const FARTHEST: f64 = 7.0;
/// First step when the curvature says nothing: a tenth of a logarithm. Steps grow by up to four from there.
const FIRST_STEP: f64 = 0.1;
/// How far a line through two points is followed, in distances between them: beyond, it is a worse beginning than the nearest point
/// itself. A judgement; a bad beginning costs time, not the result.
const FARTHEST_AHEAD: f64 = 5.0;
/// Steps outwards; a walk that is still inside the limit then is open.
const OUTWARDS: usize = 24;
/// Rounds to bring an end to the precision: halves alone would bring it to 2^-16 of the last step. Where they are spent the
/// end is where the line through the last two points puts it.
const INWARDS: usize = 16;
/// Roots of deviances this many times the limit's are too far for a straight line: halves close in faster there.
const FAR_OUTSIDE: f64 = 4.0;
/// Factor on either side of the limit by which a deviance jumps where a search has lost the valley: along a valley that is followed it changes by less between
/// points so near. A judgement.
const JUMP: f64 = 1.5;
/// Times that a walk sets out anew from where its search lost the valley. Each gets some steps farther; when they are spent the end stands where the valley was lost last.
const ANEW: usize = 8;
/// Relative precision of the distance of an end, as the root of the deviance: half a per cent of an interval's half width, below
/// what anyone reads off it.
const PRECISION: f64 = 5e-3;
/// A walk along one coordinate.
pub(crate) struct Walk<'a, G: Ground> {
    pub(super) task: &'a G,
    pub(super) coordinate: usize,
    /// The coordinates that follow.
    pub(super) free: Vec<usize>,
    /// Where it begins.
    pub(super) minimum: &'a Minimum,
    pub(super) scale: &'a Scale,
    /// Whether an end where the joint takes nearly all stiffness is open: it is the model's, not the records'.
    pub(crate) stiffness_ends: bool,
    /// How the others follow next to the minimum, per unit of the coordinate.
    tangent: Option<Vec<f64>>,
    work: G::Work,
    /// Where it has been, in the order of time.
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

/// A place on the way, and its deviance.
#[derive(Debug, Clone, Copy)]
struct Place {
    at: f64,
    deviance: f64,
}

/// How a walk ended.
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

    /// Deviance with the coordinate held at `at`; none where there is no model.
    ///
    /// Begun from the nearest known point and on the line through the two nearest; the likelier is taken, the other one only
    /// where it says that the record forbids the value.
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

    /// On the straight line through the two points nearest to `at`, next to the minimum on its tangent; inside the bounds.
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

    /// Walks outwards until the deviance passes the limit, then to the limit itself. Where the deviance jumps there, far inside the limit on one side and far outside on the
    /// other, the search has lost a valley that is narrow and bent: from its last point the walk sets out anew, by shorter steps.
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

    /// The last point inside the limit and the first outside, from a point and a first step on; none where the way is open.
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
            // Where the root of the deviance grows evenly, a little beyond the limit.
            let growth = (self.scale.limit / deviance.max(1e-3 * self.scale.limit)).sqrt();
            step = (1.1 * growth * (at - start).abs() - (at - start).abs()).clamp(0.3 * step, 4.0 * step);
            inside = Place { at, deviance };
        }
        Ok(None)
    }

    /// Whether the deviance jumps over the limit between two points.
    fn jumps(&self, inside: Place, outside: Place) -> bool {
        inside.deviance < self.scale.limit / JUMP && outside.deviance > self.scale.limit * JUMP
    }

    /// Where the limit lies between a point inside and one outside, by the line through the roots of the deviances, or halfway where they are too far apart for that.
    fn share(&self, inside: Place, outside: Place) -> f64 {
        let root = self.scale.limit.sqrt();
        let (a, b) = (inside.deviance.sqrt(), outside.deviance.sqrt());
        if b > FAR_OUTSIDE * root { 0.5 } else { ((root - a) / (b - a)).clamp(0.0, 1.0) }
    }

    /// The end of an interval between its last point inside and the first outside: the first where there is no model beyond.
    fn between(&self, inside: Place, outside: Place) -> f64 {
        let share = if outside.deviance.is_finite() { self.share(inside, outside) } else { 0.0 };
        inside.at + share * (outside.at - inside.at)
    }

    /// Whether the farthest point inside needs nearly all stiffness to be the joint's: the end is not the record's then.
    fn all_of_stiffness(&self) -> bool {
        let inside = self.visited.iter().filter(|p| p.deviance < self.scale.limit);
        let start = self.minimum.x[self.coordinate];
        let farthest = inside.max_by(|a, b| (a.at - start).abs().total_cmp(&(b.at - start).abs()));
        farthest.is_some_and(|farthest| self.task.is_at_edge(&farthest.minimum.x))
    }

    /// From a point inside and one outside to two that are next to each other or to the limit. None where the way ends not at the limit but at the edge of the model.
    fn close_in(&mut self, mut inside: Place, mut outside: Place) -> Result<Option<[Place; 2]>, Minimum> {
        let (root, start) = (self.scale.limit.sqrt(), self.minimum.x[self.coordinate]);
        for _ in 0..INWARDS {
            let near = |d: f64| (d.sqrt() - root).abs() <= PRECISION * root;
            let narrow = (outside.at - inside.at).abs() <= PRECISION * (inside.at - start).abs();
            if near(inside.deviance) || near(outside.deviance) || narrow {
                break;
            }
            // Off both ends, so that each round closes in whatever the line says.
            let share = self.share(inside, outside).clamp(0.05, 0.95);
            let at = inside.at + share * (outside.at - inside.at);
            let deviance = self.deviance(at)?.unwrap_or(f64::INFINITY);
            let place = Place { at, deviance };
            if deviance < self.scale.limit { inside = place } else { outside = place }
        }
        // Where there is no model beyond, the model itself ends the interval: of joint and force that is no finding.
        let ends_model = !outside.deviance.is_finite() || self.all_of_stiffness();
        Ok((!self.stiffness_ends || !ends_model).then_some([inside, outside]))
    }

    /// Student's t times the standard deviation by curvature.
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
