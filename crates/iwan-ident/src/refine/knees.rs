//! The knee φ_max, at which macro-slip begins, is sought along its whole range: with the knee held, the sum of squares is smooth in all other
//! unknowns.
//!
//! A valley is a local minimum of the sum of squares along the knee. A crease is a bend of the sum of squares where an amplitude of the ring-down
//! equals φ_max.

use std::f64::consts::TAU;

use iwan_core::{Decay, Motion, Reversal};
use iwan_machine::threads::{both, in_parallel};

use super::record::Windowed;
use super::release::TurningPoint;
use super::residuals::Kind;
use super::task::{Effort, FINE, ROUGH, Task, Workspace};
use crate::search::{CHI, DIRAC, KNEE, Minimum, SOFTENING, Scales};

/// φ_max over the largest amplitude where no record shall reach it: any larger value would do.
pub(crate) const KNEE_UNSEEN: f64 = 2.0;
/// Share β/(1+β) of the Dirac in the density where a scan begins: any smooth start does, because the share is sought with the knee held.
const DIRAC_AT_FIRST: f64 = 0.2;
/// The smallest φ_max over the largest amplitude that no record reaches, taken where the stiffness of the mode forbids a larger one.
const JUST_UNSEEN: f64 = 1.02;
/// Step of the scans in ln φ_max. In macro-slip the amplitudes of successive cycles differ by a few to some twenty per cent, and a valley lies
/// between two of them.
pub(crate) const STEP: f64 = 0.05;
/// Largest knee of a scan over the largest amplitude: outside what the records see, with room for a first amplitude that was estimated too small.
const HIGHEST: f64 = 1.3;
/// Smallest knee of a scan over the largest amplitude: a ring-down from sixteen times φ_max. Where the smallest amplitude of the records is larger,
/// the scan ends there.
const LOWEST: f64 = 0.06;
/// Largest knee of a scan over the largest amplitude where K_T or F_S is given: the knee then matters beyond the records too.
const HIGHEST_GIVEN: f64 = 30.0;
/// Step of a sweep in ln φ_max next to the minimum. A strongly softening joint that dissipates most of the energy in its first cycle can have two
/// knees some per cent apart that fit the other cycles alike, and both belong into the intervals.
const FINE_STEP: f64 = 0.01;
/// Number of these steps to either side of the minimum.
const CLOSE: i32 = 15;
/// Slipping half cycles of a record are counted up to this number beyond the gate's: more are enough for every purpose.
const MOST_SLIPPING: usize = 64;
/// A scan begins anew from its first point at every sixth knee, so that a neighbour which went astray leads no further.
const ANEW: usize = 6;
/// Up to this many times the limit of an interval a deviance is looked at closely: beyond, a better search does not bring a point inside the limit.
const MARGIN: f64 = 20.0;
/// Knees in a row beyond that margin after which a sweep under noise ends. A judgement, not varied.
const PATIENCE: usize = 17;
/// Largest K_T as a part of ω0² where K_T is chosen freely, so that K_∞ stays well positive.
const MOST_JOINT: f64 = 0.9;

/// Most rounds of hops over creases. A judgement: each round brings a record without noise nearer to the law's own parameters by one crease at least.
const HOP_ROUNDS: usize = 4;
/// Part of a sum of squares below which a round of hops must end for another one to follow: in a lower valley, not further down the same one.
const NEXT_VALLEY: f64 = 0.5;

/// Most valleys of a sweep that are followed to their bottom: the deepest ones.
const POLISHED: usize = 8;

/// The valleys of a scan: the points that lie no higher than their neighbours in ln φ_max, the deepest first.
pub(super) fn valleys(scan: &[Minimum]) -> Vec<Minimum> {
    let mut scan: Vec<&Minimum> = scan.iter().collect();
    scan.sort_by(|a, b| a.x[KNEE].total_cmp(&b.x[KNEE]));
    let mut found = vec![];
    for (i, minimum) in scan.iter().enumerate() {
        let beside = [i.checked_sub(1).map(|i| scan[i]), scan.get(i + 1).copied()];
        if beside.iter().flatten().all(|m| m.cost >= minimum.cost) {
            found.push((*minimum).clone());
        }
    }
    found.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    found
}

/// The sum of squares below which a sweep from `best` looks at points closely.
fn margin(best: &Minimum, limit: f64) -> f64 {
    best.cost + MARGIN * (limit - best.cost)
}

/// Knees (in ln φ_max) at distances of a hundredth and more from another knee, to both sides.
pub(super) fn close_to(knee: f64) -> Vec<f64> {
    (1..=CLOSE).flat_map(|i| [-1.0, 1.0].map(|sign| knee + sign * FINE_STEP * f64::from(i))).collect()
}

impl Task {
    /// The largest first amplitude of the records, by their estimated turning points.
    pub(super) fn loudest(&self) -> f64 {
        self.records.iter().map(|r| r.start.displacement.abs()).fold(0.0, f64::max)
    }

    /// The smallest ratio, in any record, of the smallest to the largest amplitude in its windows.
    fn quietest(&self) -> f64 {
        let part = |r: &Windowed| {
            let norms = || r.amplitudes.iter().map(|z| z.norm());
            norms().fold(f64::INFINITY, f64::min) / norms().fold(f64::MIN_POSITIVE, f64::max)
        };
        self.records.iter().map(part).fold(1.0, f64::min)
    }

    /// Whether nothing but the records decides about the joint's size: K_T, F_S and χ are all sought.
    pub(crate) fn is_open(&self) -> bool {
        self.chart.scales == Scales::SofteningAndKnee && self.free().contains(&CHI)
    }

    /// The knees of a scan as coordinates, from the largest to the smallest.
    pub(crate) fn knees(&self) -> Vec<f64> {
        let top = if self.is_open() { HIGHEST } else { HIGHEST_GIVEN };
        let middle = (self.loudest() / self.chart.amplitude).ln();
        let (high, low) = (middle + top.ln(), middle + LOWEST.max(self.quietest()).min(0.8).ln());
        let count = ((high - low) / STEP).ceil() as usize;
        (0..=count).map(|i| high - STEP * i as f64).collect()
    }

    /// `x` with its knee beyond all amplitudes of the records, and without a Dirac where its share is sought; `x` itself where K_T and F_S are given,
    /// which fix the knee.
    pub(super) fn unseen(&self, x: &[f64]) -> Vec<f64> {
        let mut x = x.to_vec();
        if self.knee().is_none() {
            return x;
        }
        let own = self.starts_at(&x).iter().map(|s| s.displacement.abs()).fold(0.0, f64::max);
        let middle = (self.loudest().max(own) / self.chart.amplitude).ln();
        if self.free().contains(&DIRAC) {
            x[DIRAC] = 0.0;
        }
        // The knee lies as far away as the stiffness allows.
        for beyond in [KNEE_UNSEEN, 1.4, 1.1, JUST_UNSEEN] {
            x[KNEE] = middle + beyond.ln();
            let p = self.chart.parameters(&x);
            if p.k_t < MOST_JOINT * (TAU * p.frequency).powi(2) {
                break;
            }
        }
        x
    }

    /// The start of a search with the knee held at `at`: softening as in `x`, with some Dirac where its share is sought and zero.
    pub(super) fn start_at_knee(&self, x: &[f64], at: f64) -> Vec<f64> {
        let mut x = x.to_vec();
        x[KNEE] = at;
        if self.free().contains(&DIRAC) && x[DIRAC] == 0.0 {
            x[DIRAC] = DIRAC_AT_FIRST;
        }
        self.with_residual_stiffness(x)
    }

    /// `x` with the softening reduced until K_∞ is positive.
    fn with_residual_stiffness(&self, mut x: Vec<f64>) -> Vec<f64> {
        let part = self.chart.stiffness_up_to(&x, MOST_JOINT);
        if part < 1.0 && self.chart.scales == Scales::SofteningAndKnee {
            x[SOFTENING] += part.ln();
        }
        x
    }

    /// Where the first searches, which compare logarithms, end at each knee of a scan, from the largest knee downwards: each search goes on from its
    /// neighbour, and at every sixth knee another one begins at `x`.
    pub(super) fn scan(&self, x: &[f64], work: &mut Workspace) -> Vec<Minimum> {
        let search = self.search(self.smooth(), Effort::SCAN);
        let mut found: Vec<Minimum> = vec![];
        for (i, at) in self.knees().into_iter().enumerate() {
            let near = found.last().map(|m| self.start_at_knee(&m.x, at));
            let near = near.and_then(|x| self.seek(Kind::Logarithms, &x, &search, work));
            let fresh = (near.is_none() || i % ANEW == 0).then(|| self.start_at_knee(x, at));
            let fresh = fresh.and_then(|x| self.seek(Kind::Logarithms, &x, &search, work));
            found.extend(fresh.into_iter().chain(near).min_by(|a, b| a.cost.total_cmp(&b.cost)));
        }
        found
    }

    /// The least sum of squares with the knee held at `at`, among searches from each of `from`.
    pub(crate) fn at_knee(
        &self,
        from: &[&[f64]],
        at: f64,
        tolerance: f64,
        work: &mut Workspace,
    ) -> Option<Minimum> {
        let ends = from.iter().filter_map(|x| {
            let mut x = x.to_vec();
            x[KNEE] = at;
            self.minimise(&self.with_residual_stiffness(x), self.smooth(), tolerance, work)
        });
        ends.min_by(|a, b| a.cost.total_cmp(&b.cost))
    }

    /// The least sums of squares at held knees, from `best` outwards to both sides, and the minima over all unknowns next to the deepest few of their valleys. Under noise valleys above
    /// the sweep's margin stay as they are: no minimum next to them lies below the limit.
    pub(crate) fn swept(&self, best: &Minimum, limit: f64, tolerance: f64) -> Vec<Minimum> {
        let mut sweep = self.sweep(best, limit, tolerance);
        let all = self.may_lie_beside_a_narrow_valley(best);
        let most = if all { f64::INFINITY } else { margin(best, limit) };
        let polished = self.polished(&sweep, most);
        sweep.extend(polished);
        sweep
    }

    /// The least sums of squares at held knees, from `best` outwards to both sides. Points below a margin, `MARGIN` times as far above `best` as
    /// `limit`, are sought to the relative `tolerance`. Under noise a sweep ends when none of the last few points lies below the margin; without
    /// noise valleys are so narrow that none is ever seen from afar, and the whole range is taken at half steps.
    pub(super) fn sweep(&self, best: &Minimum, limit: f64, tolerance: f64) -> Vec<Minimum> {
        let mut knees = self.knees();
        let (high, low) = (knees[0], knees[knees.len() - 1]);
        let all = self.may_lie_beside_a_narrow_valley(best);
        if all {
            let between = knees.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect::<Vec<_>>();
            knees.extend(between);
        }
        let middle = best.x[KNEE];
        let close: Vec<f64> = close_to(middle).into_iter().filter(|k| (low..=high).contains(k)).collect();
        let go = |is_above: bool| {
            let side = |knees: &[f64]| -> Vec<f64> {
                knees.iter().copied().filter(|knee| (*knee > middle) == is_above).collect()
            };
            self.outwards(best, [side(&knees), side(&close)], (limit, tolerance), !all)
        };
        let (above, below) = both(&|| go(true), &|| go(false));
        [vec![best.clone()], above, below].concat()
    }

    /// One side of a sweep over `knees` a step apart. Those `close` to `best` are taken as well, unless the knee a step away lies below the limit: the valley is then wider than a step.
    /// With `ends_early` the sweep ends after `PATIENCE` knees in a row above the margin.
    fn outwards(
        &self,
        best: &Minimum,
        [mut knees, close]: [Vec<f64>; 2],
        (limit, tolerance): (f64, f64),
        ends_early: bool,
    ) -> Vec<Minimum> {
        let (mut found, mut work) = (vec![], Workspace::default());
        let (mut near, mut outside, margin) = (best.x.clone(), 0, margin(best, limit));
        let away = |knee: &f64| (knee - best.x[KNEE]).abs();
        let order = |knees: &mut Vec<f64>| knees.sort_by(|a, b| away(a).total_cmp(&away(b)));
        let mut at_knee = |near: &[f64], at: f64| {
            let mut x = self.start_at_knee(near, at);
            x[KNEE] = at;
            self.minimise_with(&x, self.smooth(), Effort::of_sweeps(margin, tolerance), &mut work)
        };
        order(&mut knees);
        let step = knees.iter().position(|knee| away(knee) >= STEP);
        let a_step_away = step.filter(|_| ends_early).and_then(|i| at_knee(&best.x, knees[i]));
        if let Some(accepted) = a_step_away.filter(|minimum| minimum.cost < limit) {
            (near, knees) = (accepted.x.clone(), knees.split_off(step.map_or(0, |i| i + 1)));
            found.push(accepted);
        } else {
            knees.extend(close);
            order(&mut knees);
        }
        for at in knees {
            let Some(minimum) = at_knee(&near, at) else { continue };
            near.clone_from(&minimum.x);
            outside = if minimum.cost < margin { 0 } else { outside + 1 };
            found.push(minimum);
            if outside >= PATIENCE && ends_early {
                break;
            }
        }
        found
    }

    /// The minima over all unknowns next to the deepest few valleys of a sweep that lie below a sum of squares.
    pub(super) fn polished(&self, sweep: &[Minimum], below: f64) -> Vec<Minimum> {
        let mut found = valleys(sweep);
        found.retain(|valley| valley.cost < below);
        found.truncate(POLISHED);
        let bottom = |m: &Minimum| self.minimise(&m.x, self.free(), FINE, &mut Workspace::default());
        in_parallel(&found, found.len(), &bottom).into_iter().flatten().collect()
    }

    /// Leaves creases by hops of the knee: the knee is moved by each of the `hops` to both sides, all else follows, then all unknowns are free. A hop
    /// to a lower minimum is kept, and rounds of all hops go on while they lead to lower valleys.
    pub(super) fn hop(&self, mut best: Minimum, hops: &[f64], work: &mut Workspace) -> Minimum {
        if self.knee().is_none() {
            return best;
        }
        for _ in 0..HOP_ROUNDS {
            let before = best.cost;
            for step in hops {
                for sign in [-1.0, 1.0] {
                    let found = self
                        .at_knee(&[&best.x], best.x[KNEE] + sign * step, ROUGH, work)
                        .filter(|m| m.cost < 4.0 * best.cost)
                        .and_then(|m| self.minimise(&m.x, self.free(), FINE, work));
                    best = found.filter(|f| f.cost < best.cost).unwrap_or(best);
                }
            }
            if best.cost > NEXT_VALLEY * before {
                break;
            }
        }
        best
    }

    /// Largest amplitude of the model's ring-downs over φ_max.
    pub(crate) fn slip_ratio(&self, x: &[f64]) -> f64 {
        let largest = self.starts_at(x).iter().map(|s| s.displacement.abs()).fold(0.0, f64::max);
        self.chart.parameters(x).model().map_or(f64::INFINITY, |(_, joint)| largest / joint.phi_max())
    }

    /// Half cycles of the model's ring-downs in which the joint slips as a whole, summed over the records. In a record in a band those half cycles do
    /// not count that one window (the gate) covers: what filter and windows make of the sudden onset of other modes lasts as long, and looks like a
    /// knee just below the largest amplitude.
    pub(crate) fn slipping_half_cycles(&self, x: &[f64]) -> usize {
        let Ok((oscillator, joint)) = self.chart.parameters(x).model() else { return 0 };
        let one = |(start, record): (TurningPoint, &Windowed)| -> Option<usize> {
            let gate = record.gate_half_cycles();
            let most = MOST_SLIPPING + gate;
            let stack = vec![Reversal::default(); most + 4];
            let held = Motion::held_at(start.displacement);
            let mut decay = Decay::new(&oscillator, &joint, 0.0, held, stack).ok()?;
            let mut from = start.displacement;
            for count in 0..most {
                let to = decay.next()?.displacement;
                if 0.5 * (from - to).abs() <= joint.phi_max() {
                    return Some(count.saturating_sub(gate));
                }
                from = to;
            }
            Some(MOST_SLIPPING)
        };
        self.starts_at(x).into_iter().zip(&self.records).filter_map(one).sum()
    }

    /// Whether no record reaches φ_max.
    pub(crate) fn is_micro_slip(&self, x: &[f64]) -> bool {
        self.slip_ratio(x) < 1.0
    }
}
