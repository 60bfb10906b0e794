//! The chosen model and the intervals of its unknowns.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use iwan_core::Progress;
use iwan_machine::threads::in_parallel;

use super::model::{CoupledModel, Series};
use super::outcome::{CoupledCombination, CoupledEstimate};
use super::search::{LAST, is_white, settled, weights};
use super::unknowns::Unknown;
use crate::error::Error;
use crate::estimate::{About, Found, Interval, Model, Profiles, Told, Weights, near, widening};

/// Largest number of times that all walks begin anew because one of them met a better point.
const MOST_ANEW: usize = 3;
/// Factor on the variance of unknowns of a joint: K_T, F_S, χ, β and compliance. The sum of squares has a crease wherever a slider begins to slip, and searches end in one of
/// several valleys (local minima) between creases: estimates scatter by 1.2 to 1.3 times what the curvature of one valley says. In a hundred repeats at 40 dB intervals held
/// the truth in 85 to 89 without the factor, and in 94 to 96 with it.
const CREASED: f64 = 1.5;
/// Share of the correction for time steps that counts as its own error, so that intervals do not shrink to nothing where there is no noise. A judgement: the next term of the
/// series is the fourth power of the step, smaller than the one subtracted by the square of ω h, a fortieth at forty steps a period.
const STILL_STEPPING: f64 = 0.1;
/// Number of stretches of each series that are taken for independent of each other. On the paper's beam whole series widen intervals by 14, halves by 10, quarters by 7 and
/// eighths by 5: the remainder is alike over long times. Whole series would say nothing of an unknown that only one of them tells, such as the damping of a mode in one
/// record.
const STRETCHES: usize = 2;
/// The interval of β is closed only where the best fit without a Dirac has a deviance above this. One parameter more gains 4 at the 95 % level; but a motion has a crease
/// wherever a slider begins to slip, so that walks along β end in valleys of their own: in 7 repeats with β = 0.02 at 40 dB they ended within ±0.005
/// about values from 0 to 0.024, and held the truth in 5. Without a Dirac those fits had deviances up to 22. As for the knee of a mode
/// ([`profile`](mod@crate::profile)), 25 is a judgement.
const DIRAC_SEEN: f64 = 25.0;

/// The chosen model with its intervals.
pub(super) struct Certain<'a> {
    pub(super) model: CoupledModel<'a>,
    pub(super) found: Found,
    intervals: Vec<(usize, Interval)>,
    told: Told,
    /// Factor by which the correlation of the residuals widens variances.
    inflation: f64,
}

impl<'a> Certain<'a> {
    /// Finds the intervals about the minimum of a model.
    pub(super) fn about(
        mut model: CoupledModel<'a>,
        found: Found,
        progress: Progress<'_>,
    ) -> Result<Self, Error> {
        let mut found = settled(&model, &found.x).unwrap_or(found);
        let free: Vec<usize> = (0..found.x.len()).collect();
        let wanted: Vec<usize> =
            free.iter().copied().filter(|j| is_of_structure(model.form.unknowns[*j])).collect();
        // Where no blow tells a Dirac, searches end at any β; a walk would meet the better minimum late, and all walks would begin anew from there.
        for j in free.iter().filter(|j| matches!(model.form.unknowns[**j], Unknown::Beta(_))) {
            let lower = without_dirac(&model, &found, &free, *j).and_then(|found| settled(&model, &found.x));
            found = lower.filter(|lower| lower.cost < found.cost).unwrap_or(found);
        }
        for round in 0..=MOST_ANEW {
            let Weights { inflation, .. } = weights(&model, &found);
            let freedom = (model.count() as f64 - free.len() as f64).max(1.0);
            let variance = (inflation * found.cost / freedom).max(still_stepping(&model));
            let about = About { found: &found, free: &free, variance, settled: round == MOST_ANEW };
            // Noise pulls in no direction; what the law misses pulls the unknowns another way in each stretch of a record.
            let wider = if is_white(inflation) {
                free.iter()
                    .map(|j| if is_of_joint(model.form.unknowns[*j]) { CREASED } else { 1.0 })
                    .collect()
            } else {
                widening(&model, &found.x, &free, variance, &stretches(&model))
            };
            // Each walk has a thread of its own: two records on two threads would wait for each other at each step of a search.
            let threads = std::mem::replace(&mut model.threads, 1);
            let walked = walked(&model, about, (&wanted, &wider), (threads, progress))?;
            model.threads = threads;
            match walked {
                Ok(mut all) => {
                    for (j, interval) in wanted.iter().zip(&mut all) {
                        let beta = matches!(model.form.unknowns[*j], Unknown::Beta(_));
                        if beta && *interval != Interval::default() && !has_dirac(&model, about, *j) {
                            *interval = Interval::default();
                        }
                    }
                    let intervals = wanted.iter().copied().zip(all).collect();
                    let told = Told::about(&model, &found, &free, variance)?;
                    return Ok(Self { model, found, intervals, told, inflation });
                }
                Err(better) => found = settled(&model, &better.x).unwrap_or(better),
            }
        }
        Err(Error::Stopped)
    }

    /// Whether the residuals are noise, as far as their correlation says.
    pub(super) fn leaves_noise(&self) -> bool {
        is_white(self.inflation)
    }

    pub(super) fn estimates(&self) -> Vec<CoupledEstimate> {
        let of = |(j, interval): &(usize, Interval)| {
            let unknown = self.model.form.unknowns[*j];
            let value = |x: f64| self.model.form.value(unknown, x);
            let ends = [interval.low.map(value), interval.high.map(value)];
            let turned = matches!((ends[0], ends[1]), (Some(a), Some(b)) if a > b);
            let [low, high] = if turned { [ends[1], ends[0]] } else { ends };
            CoupledEstimate { unknown, value: value(self.found.x[*j]), low, high }
        };
        self.intervals.iter().map(of).collect()
    }

    /// Directions by the unknowns of the structure; the initial motions of records are left out.
    pub(super) fn combinations(&self) -> Vec<CoupledCombination> {
        let own: Vec<usize> = self.intervals.iter().map(|(j, _)| *j).collect();
        let of = |c: &crate::estimate::Combination| CoupledCombination {
            deviation: c.deviation,
            direction: own.iter().map(|j| c.direction[*j]).collect(),
        };
        self.told.combinations().iter().map(of).collect()
    }
}

/// Ranges of residuals that are taken for independent of each other where the law misses something.
fn stretches(model: &CoupledModel<'_>) -> Vec<Range<usize>> {
    let of = |range: Range<usize>| {
        let (first, length) = (range.start, range.len());
        (0..STRETCHES).map(move |k| first + k * length / STRETCHES..first + (k + 1) * length / STRETCHES)
    };
    model.ranges().into_iter().flat_map(of).filter(|stretch| !stretch.is_empty()).collect()
}

/// The intervals of the unknowns `wanted`, walked on `threads` threads; `wider` are factors on the variance by unknown. The error is a better minimum met on the way.
fn walked(
    model: &CoupledModel<'_>,
    about: About<'_>,
    (wanted, wider): (&[usize], &[f64]),
    (threads, progress): (usize, Progress<'_>),
) -> Result<Result<Vec<Interval>, Found>, Error> {
    let profiles = Profiles::about(model, about);
    let walks: Vec<(usize, f64)> = wanted.iter().flat_map(|j| [(*j, -1.0), (*j, 1.0)]).collect();
    let (done, stopped, met) = (AtomicUsize::new(0), AtomicBool::new(false), AtomicBool::new(false));
    let walk = |(j, direction): &(usize, f64)| {
        // Walks begin in their order. Those before a walk that met a better point have begun, so that the first better point is the same for any number of threads.
        if stopped.load(Ordering::Relaxed) || met.load(Ordering::Relaxed) {
            return Ok(None);
        }
        let end = profiles.end(*j, *direction, wider[*j]);
        met.fetch_or(end.is_err(), Ordering::Relaxed);
        let share = (done.fetch_add(1, Ordering::Relaxed) + 1) as f64 / walks.len() as f64;
        stopped.fetch_or(progress(share).is_break(), Ordering::Relaxed);
        end
    };
    let ends = in_parallel(&walks, threads, &walk);
    if stopped.load(Ordering::Relaxed) { Err(Error::Stopped) } else { Ok(Interval::of_ends(ends)) }
}

/// Variance of the residuals (in their unit) that the error of the steps still leaves.
fn still_stepping(model: &CoupledModel<'_>) -> f64 {
    let of = |(series, range): (&Series, Range<usize>)| {
        range.len() as f64 * (STILL_STEPPING * series.stepping / series.deviation).powi(2)
    };
    model.series.iter().zip(model.ranges()).map(of).sum::<f64>() / (model.count() as f64).max(1.0)
}

/// The minimum without a Dirac in one joint; `beta` is the index of that joint's β.
fn without_dirac(model: &CoupledModel<'_>, found: &Found, free: &[usize], beta: usize) -> Option<Found> {
    let mut start = found.x.clone();
    start[beta] = 0.0;
    let others: Vec<usize> = free.iter().copied().filter(|j| *j != beta).collect();
    near(model, &start, &others, LAST)
}

/// Whether the records speak clearly against a joint without a Dirac; `beta` is the index of the joint's β.
fn has_dirac(model: &CoupledModel<'_>, about: About<'_>, beta: usize) -> bool {
    let without = without_dirac(model, about.found, about.free, beta);
    without.is_none_or(|without| without.cost - about.found.cost > DIRAC_SEEN * about.variance)
}

/// Whether an unknown belongs to a joint alone.
fn is_of_joint(unknown: Unknown) -> bool {
    matches!(
        unknown,
        Unknown::KT(_) | Unknown::FS(_) | Unknown::Chi(_) | Unknown::Beta(_) | Unknown::Compliance(_)
    )
}

/// Whether an unknown belongs to modes and joints, and not to one record.
fn is_of_structure(unknown: Unknown) -> bool {
    !matches!(unknown, Unknown::Displacement(..) | Unknown::Velocity(..))
}
