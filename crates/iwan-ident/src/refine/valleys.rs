//! The searches: from many starts to the best minimum, over creases, without macro-slip, without a joint.

use std::f64::consts::TAU;

use super::task::{Effort, FINE, ROUGH, Task, Workspace, no_ring_down};
use crate::curve_fit::predict;
use crate::error::Error;
use crate::parameters::{COUNT, Parameter, Parameters};
use crate::search::{Chart, Minimum, Scales, TOLERANCE};

// What was tried below: noise-free ring-downs of the half-cycle map, "mode 1" (Table 2 with ζ_v = 2.5e-4) released at 0.3,
// 1.05 and 1.5 φ_max, and two more laws released at 0.5 and 2 φ_max. All but the one at 1.05 end at the truth, as far as
// they tell it, whatever these constants are; that one, in which a single cycle slips as a whole, ends in a neighbouring valley.

/// φ_max over the largest amplitude of the further starts. A knee of 1.0 alone, 0.4 and 10, and eight knees from 0.2 to 10
/// end in the same valleys in all that was tried; at 0.3 φ_max an end of ζ_v or χ that is closed with four is open with two
/// or eight.
const KNEES: [f64; 4] = [0.4, 1.0, 2.5, 10.0];
/// Share β/(1+β) of the Dirac in the further starts: little and much. Little alone ends in the same valleys.
const DIRACS: [f64; 2] = [0.02, 0.4];
/// Part of ω0² that the joint has at most at a start where nothing else limits it: K_∞ stays well positive.
const MOST_JOINT: f64 = 0.9;
/// Part of ω0² that the joint has at the start with next to none: it shifts the frequency by 5e-5, so that derivatives with respect
/// to it are still seen.
const LITTLE_JOINT: f64 = 1e-4;
/// φ_max over the largest amplitude where no record reaches it: any larger one would do.
pub(crate) const KNEE_UNSEEN: f64 = 2.0;
/// Hops over creases. The longest is too short where the knee is least known: released at 1.05 φ_max, K_T is found 21 % too
/// low (an interval that misses), with hops twice as long 5.7 % (an interval that holds), with none or with those of at
/// least 0.05 alone 24 %. Hops of the Dirac, and those over 0.1, change nothing in what was tried.
const HOPS: [Hop; 10] = [
    Hop::knee(-0.03),
    Hop::knee(0.03),
    Hop::knee(-0.06),
    Hop::knee(0.06),
    Hop::knee(-0.12),
    Hop::knee(0.12),
    Hop::knee(-0.25),
    Hop::knee(0.25),
    Hop::dirac(-0.03),
    Hop::dirac(0.03),
];
/// Relative residual that hides the creases: above it noise decides, and hops cost time only. Ten times as much changes
/// nothing without noise; with 0 no record is hopped on, and the one released at 1.05 φ_max ends 3 % further off.
const CREASE: f64 = 5e-4;
/// Most rounds of hops; 1 and 16 end in the same valleys in what was tried.
const ROUNDS: usize = 8;
/// A round must bring the sum of squares down to this part for another one; 0.5 and 0.99 end in the same valleys.
const WORTH: f64 = 0.9;
/// Starts that the last search goes on from; one and six end in the same valleys.
const KEPT: usize = 3;

/// A step of one coordinate of the chart that moves the knee, while all others follow.
struct Hop {
    coordinate: usize,
    step: f64,
}

impl Hop {
    /// Of ln K_T, or of ln F_S where that is the coordinate.
    const fn knee(step: f64) -> Self {
        Self { coordinate: 4, step }
    }

    /// Of the Dirac's share β/(1+β).
    const fn dirac(step: f64) -> Self {
        Self { coordinate: 5, step }
    }
}

impl Task {
    /// `first`, the same softening with knees and Diracs elsewhere, and next to no joint.
    fn starts(&self, first: &Parameters) -> Result<Vec<Vec<f64>>, Error> {
        let mut starts = vec![self.coordinates(first)?];
        let loudest = self.records.iter().map(|r| r.start.displacement.abs()).fold(0.0, f64::max);
        let (_, joint) = first.model()?;
        for knee in KNEES {
            for dirac in DIRACS {
                let (phi_max, beta) = (knee * loudest, dirac / (1.0 - dirac));
                let power = joint.r() * phi_max.powf(first.chi + 1.0) / (first.chi + 1.0);
                let c = (first.chi + 1.0) / (first.chi + 2.0);
                let k_t = (power * (1.0 + beta)).min(MOST_JOINT * (TAU * first.frequency).powi(2));
                let f_s = phi_max * k_t * (beta + c) / (1.0 + beta);
                let mut start = Parameters { k_t, f_s, beta, ..*first };
                for parameter in &self.held {
                    match parameter {
                        Parameter::KT => start.k_t = first.k_t,
                        Parameter::FS => start.f_s = first.f_s,
                        Parameter::Beta => start.beta = first.beta,
                        _ => {}
                    }
                }
                starts.push(self.coordinates(&start)?);
            }
        }
        if self.held.is_empty() {
            let model = predict(first, loudest)?;
            let omega_squared = (TAU * model.frequency).powi(2);
            let k_t = LITTLE_JOINT * omega_squared;
            let damping_ratio = model.dissipation / (TAU * omega_squared * loudest * loudest);
            let (frequency, f_s) = (model.frequency, k_t * loudest);
            starts.push(self.coordinates(&Parameters { frequency, damping_ratio, k_t, f_s, ..*first })?);
        }
        Ok(starts)
    }

    /// Where the first searches end, from each start; each half of the starts on a thread of its own.
    fn logarithmic(&self, starts: &[Vec<f64>]) -> Vec<Minimum> {
        let search = self.search(self.free(), Effort::ROUGH);
        let ends = |starts: &[Vec<f64>]| -> Vec<Minimum> {
            let mut work = Workspace::default();
            let mut log = |x: &[f64], out: &mut [f64]| self.log_residuals(x, out, &mut work);
            starts.iter().filter_map(|x| search.run(&mut log, x)).collect()
        };
        let (one, other) = starts.split_at(starts.len() / 2);
        std::thread::scope(|scope| {
            let second = scope.spawn(|| ends(other));
            let mut found = ends(one);
            found.extend(second.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
            found
        })
    }

    /// The best of all searches, roughly.
    pub(crate) fn solve(&mut self, first: &Parameters) -> Result<Minimum, Error> {
        let mut work = Workspace::default();
        let mut found = self.logarithmic(&self.starts(first)?);
        found.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        let Some(nearest) = found.first() else { return Err(no_ring_down()) };
        self.weigh(&nearest.x, &mut work);
        let mut best: Option<Minimum> = None;
        for near in found.iter().take(KEPT) {
            let minimum = self.minimise(&near.x, self.free(), ROUGH, &mut work);
            best = best.into_iter().chain(minimum).min_by(|a, b| a.cost.total_cmp(&b.cost));
        }
        let best = best.ok_or_else(no_ring_down)?;
        self.weigh(&best.x, &mut work);
        let cost = self.cost(&best.x, &mut work).ok_or_else(no_ring_down)?;
        Ok(Minimum { cost, ..best })
    }

    /// The minimum itself, next to a rough one.
    pub(crate) fn finish(&mut self, rough: &Minimum) -> Result<Minimum, Error> {
        let mut work = Workspace::default();
        let mut best = self.minimise(&rough.x, self.free(), FINE, &mut work).ok_or_else(no_ring_down)?;
        if self.refined(&best).relative_residual < CREASE {
            best = self.minimise(&best.x, self.free(), TOLERANCE, &mut work).ok_or_else(no_ring_down)?;
            best = self.hop(best, &mut work);
            self.weigh(&best.x, &mut work);
            best = self.minimise(&best.x, self.free(), TOLERANCE, &mut work).ok_or_else(no_ring_down)?;
        }
        Ok(best)
    }

    /// Leaves creases of the sum of squares: it has one wherever an amplitude of the ring-down equals φ_max, because
    /// the dissipation has a bend there. The knee and the Dirac are moved, all else follows, then all are free.
    fn hop(&self, mut best: Minimum, work: &mut Workspace) -> Minimum {
        let free = self.free();
        for _ in 0..ROUNDS {
            let before = best.cost;
            for Hop { coordinate, step } in HOPS {
                if !free.contains(&coordinate) {
                    continue;
                }
                let (mut x, (low, high)) = (best.x.clone(), self.bounds()[coordinate]);
                x[coordinate] = (x[coordinate] + step).clamp(low, high);
                let others = free.iter().copied().filter(|j| *j != coordinate).collect();
                let found = self
                    .minimise(&x, others, ROUGH, work)
                    .and_then(|m| self.minimise(&m.x, free.clone(), ROUGH, work));
                best = found.filter(|f| f.cost < best.cost).unwrap_or(best);
            }
            if best.cost > WORTH * before {
                break;
            }
        }
        best
    }

    /// The least sum of squares when the joint never slips as a whole: no Dirac, φ_max as large as ω0² allows; from
    /// several points. None where a held parameter or that limit forbids it.
    pub(crate) fn micro_slip(&self, from: &[&[f64]]) -> Option<Minimum> {
        let (stiffness, dirac) = (self.chart.index(Parameter::KT), self.chart.index(Parameter::Beta));
        let free = self.free();
        let given = !(free.contains(&stiffness) && free.contains(&dirac));
        if self.chart.scales != Scales::SofteningAndStiffness || given {
            return None;
        }
        let others: Vec<usize> = free.into_iter().filter(|j| *j != stiffness && *j != dirac).collect();
        let mut work = Workspace::default();
        let mut best: Option<Minimum> = None;
        for x in from {
            let mut x = x.to_vec();
            (x[stiffness], x[dirac]) = (MOST_JOINT.ln(), 0.0);
            let mut log = |x: &[f64], out: &mut [f64]| self.log_residuals(x, out, &mut work);
            let near = self.search(others.clone(), Effort::ROUGH).run(&mut log, &x);
            let found = near.and_then(|m| self.minimise(&m.x, others.clone(), FINE, &mut work));
            best = best.into_iter().chain(found).min_by(|a, b| a.cost.total_cmp(&b.cost));
        }
        best.filter(|found| self.is_micro_slip(&found.x)).map(|found| self.with_near_knee(found))
    }

    /// The same ring-downs with φ_max at twice the largest amplitude.
    fn with_near_knee(&self, found: Minimum) -> Minimum {
        let p = self.chart.parameters(&found.x);
        let Ok((oscillator, joint)) = p.model() else { return found };
        let phi_max = KNEE_UNSEEN * self.loudest(&found.x);
        let k_t = joint.r() * phi_max.powf(p.chi + 1.0) / (p.chi + 1.0);
        if k_t >= MOST_JOINT * oscillator.omega0().powi(2) {
            return found;
        }
        let mut x = found.x.clone();
        x[self.chart.index(Parameter::KT)] = (k_t / oscillator.omega0().powi(2)).ln();
        Minimum { x, ..found }
    }

    /// The largest amplitude of the model's ring-downs.
    fn loudest(&self, x: &[f64]) -> f64 {
        self.starts_at(x).iter().map(|start| start.displacement.abs()).fold(0.0, f64::max)
    }

    /// Whether no record reaches φ_max.
    fn is_micro_slip(&self, x: &[f64]) -> bool {
        self.chart.parameters(x).model().is_ok_and(|(_, joint)| joint.phi_max() > self.loudest(x))
    }

    /// Goes on from a better point; none when its valley is not deeper.
    pub(crate) fn resume(&self, better: &Minimum, than: &Minimum) -> Option<Minimum> {
        let found = self.minimise(&better.x, self.free(), FINE, &mut Workspace::default())?;
        (found.cost < than.cost).then_some(found)
    }

    /// The records without a joint: `linear` holds one that is as good as none.
    pub(crate) fn without_joint(
        &self,
        linear: &Parameters,
        minimum: &Minimum,
    ) -> Result<(Self, Minimum), Error> {
        let joint = [Parameter::KT, Parameter::FS, Parameter::Chi, Parameter::Beta];
        let mut task = self.clone();
        task.held.extend(joint.iter().filter(|p| !self.held.contains(p)));
        task.chart = Chart::holding(&task.held, self.chart.amplitude);
        let mut x = task.coordinates(linear)?;
        x[COUNT..].copy_from_slice(&minimum.x[COUNT..]);
        let mut work = Workspace::default();
        let mut log = |x: &[f64], out: &mut [f64]| task.log_residuals(x, out, &mut work);
        let near = task.search(task.free(), Effort::ROUGH).run(&mut log, &x).ok_or_else(no_ring_down)?;
        let found = task.minimise(&near.x, task.free(), TOLERANCE, &mut work).ok_or_else(no_ring_down)?;
        Ok((task, found))
    }
}
