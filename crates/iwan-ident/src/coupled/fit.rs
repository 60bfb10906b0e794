//! The whole fit in one call: models, comparison, intervals and warnings.

use std::ops::Range;
use std::sync::atomic::Ordering;

use iwan_core::progress::part;

use super::beginning::{Opened, shapes_at_force};
use super::informed::{Left, one_sided, without_knees};
use super::intervals::Certain;
use super::loads;
use super::model::{CoupledModel, FIRST, Series};
use super::outcome::{CoupledFit, FittedSharing, Misfit};
use super::records::{CoupledRecord, CoupledTask};
use super::search::{grown, is_white, reweight, settled, through, weights};
use super::starts::{by_themselves, drawn, linear, shared, uncoupled};
use super::unknowns::{Form, Given, Sharing, Values};
use crate::error::Error;
use crate::estimate::{Found, Model, near};
use crate::parameters::Parameters;

/// Further joints are tried only where the best model leaves more than this share of the records, and more than noise. Two modes and one joint leave 0.8 to
/// 1.1 % of the paper's beam (1.8 % of its worst series), because the modes left out do not follow at once. Two joints then fit that remainder: they leave 0.5 %, take
/// twenty times as long, find K_T 42,000 instead of 31,600, and miss blows that were kept out by 5.4 % where one joint misses 3.5 %.
const LEAVES: f64 = 0.02;
/// Models that leave less than this share of the records count as equally good: smaller remainders are the error of time steps and the digits of files. Without this limit
/// joints of next to no strength were found in linear modes without noise.
const EXACT: f64 = 1e-5;
/// Largest number of time steps of all records together with which several joints are tried: four measured decays of 118,000 steps were not through after
/// twenty minutes. With more, a warning says that they were not tried.
const MOST_STEPS: usize = 50_000;
/// Factor on the number of steps (and its square on the number of sliders) of the finer run that the search is corrected by at its end; the change is extrapolated to
/// infinitely fine steps. Not extrapolated, a sixteenth of the change stays in the records, and moves the participations of ten thousand samples at 40 dB by two standard
/// deviations.
const FINER: usize = 4;
/// Number of corrections, each at the values that the one before led to. The first one is made at values that the coarse steps have moved; its own error moves K_T by more
/// than a standard deviation at 40 dB. The second leaves the square of that error.
const CORRECTIONS: usize = 2;
/// A warning is given where a model leaves this many times more with its time steps corrected than without: its minimum is then not where the search had ended. That was found
/// far from the right values, where nothing describes the records. A judgement.
const UNSETTLED: f64 = 2.0;
/// Share of the work done when the linear modes, the uncoupled ones and those with shared joints are fitted; the rest goes to intervals. A judgement that affects
/// the display of progress alone.
const FITTED: [f64; 3] = [0.02, 0.15, 0.45];
/// Largest number of shared joints that is tried: two modes that share two joints have as many unknowns as two modes can tell.
const MOST_JOINTS: usize = 2;

/// Fits modes that share joints to several records at once, and beside them modes with joints of their own and linear modes.
///
/// Searches start from the modes fitted by themselves, with several values of K_T and F_S and all signs of the participation, and from random joints in the whole plausible
/// range. They run in windows that grow from a tenth of the records to the whole. Residuals are relative to each record and mode. The models are compared by Schwarz's
/// criterion with as many independent residuals as their correlation leaves. Intervals of the chosen model are by profile likelihood, and wider where it leaves more than
/// noise ([`widening`](crate::estimate::widening)). Where it leaves noise only, each series is weighted by its own noise.
///
/// # Errors
/// [`Error::OutOfRange`], [`Error::Length`], [`Error::NotFinite`], [`Error::TooShort`] and [`Error::Model`] for what does not fit;
/// [`Error::Refused`] when no start has a motion; [`Error::Stopped`].
///
/// ```no_run
/// use std::sync::atomic::AtomicBool;
/// use iwan_core::progress::UNWATCHED;
/// use iwan_ident::{Parameters, curves::Quantity};
/// use iwan_ident::coupled::{CoupledRecord, CoupledTask, Seen, Sharing, UncoupledMode, fit_coupled};
/// # fn hits() -> Vec<CoupledRecord> { Vec::new() }
/// let records: Vec<CoupledRecord> = hits();
/// let mode = |name: &str, frequency, k_t| UncoupledMode {
///     name: name.into(),
///     parameters: Parameters { frequency, damping_ratio: 1e-3, k_t, f_s: 200.0, chi: -0.3, beta: 0.1 },
/// };
/// let modes = [mode("bending 1", 132.0, 4e4), mode("bending 3", 719.0, 1e6)];
/// let task = CoupledTask {
///     records: &records, held_out: &[], modes: &modes, quantity: Quantity::Acceleration, seen: Seen::Modes,
///     shape_at_force: None, threads: 2, stopped: &AtomicBool::new(false), progress: UNWATCHED,
/// };
/// let fit = fit_coupled(&task)?;
/// assert_eq!(fit.best().sharing, Sharing::Shared(1));
/// # Ok::<(), iwan_ident::Error>(())
/// ```
pub fn fit_coupled(task: &CoupledTask<'_>) -> Result<CoupledFit, Error> {
    task.check()?;
    let opened = Opened::new(task, task.records);
    let fitting = Fitting { task, opened: &opened, reference: reference(task, &opened) };
    let modes: Vec<Parameters> = task.modes.iter().map(|m| m.parameters).collect();
    let done = |share: f64| if (task.progress)(share).is_break() { Err(Error::Stopped) } else { Ok(()) };
    let first = fitting.found(Sharing::Linear, |form| linear(form, &modes))?;
    done(FITTED[0])?;
    let largest = opened.largest();
    let alone = fitting.found(Sharing::Uncoupled, |form| {
        [uncoupled(form, &modes), drawn(form, &modes, &largest)].concat()
    })?;
    let own = alone.0.form.values(&alone.1.x).map_or_else(|| modes.clone(), |values| by_themselves(&values));
    done(FITTED[1])?;
    let mut all = vec![first, alone];
    let (steps, mut warnings) = (opened.steps(), loads::at_odds(task, &opened, &fitting.reference));
    let at_odds = !warnings.is_empty();
    for joints in 1..=MOST_JOINTS.min(modes.len()) {
        // Further joints would also fit what is wrong with a load.
        if joints > 1 && (at_odds || !leaves_something(&all) || fitting.doubted(best_of(&all)).is_some()) {
            break;
        }
        if joints > 1 && steps > MOST_STEPS {
            warnings.push(format!(
                "{joints} shared joints were not tried: the records have {steps} time steps together, more than {MOST_STEPS}, and the search takes \
                 many minutes; cut the records, or give fewer"
            ));
            break;
        }
        let found = fitting.found(Sharing::Shared(joints), |form| {
            if joints > 1 {
                return shared(form, &own);
            }
            [shared(form, &own), shared(form, &modes), drawn(form, &modes, &largest)].concat()
        });
        let searched_on = if joints == 1 { 0 } else { all.len() };
        let refused = match found {
            Ok(found) => {
                all.push(found);
                None
            }
            // A model that could not be searched for says nothing against those that were found.
            Err(Error::Refused { finding, .. }) => Some(finding),
            Err(error) => return Err(error),
        };
        through(&mut all, searched_on);
        if let Some(finding) = refused {
            let plural = if joints == 1 { "joint" } else { "joints" };
            warnings
                .push(format!("{joints} shared {plural} could not be held against the records: {finding}"));
            break;
        }
        done(FITTED[2])?;
    }
    let criteria = criteria(&all);
    let chosen = (0..all.len()).min_by(|a, b| criteria[*a].total_cmp(&criteria[*b])).unwrap_or(0);
    let models = all
        .iter()
        .zip(&criteria)
        .map(|((model, found), criterion)| fitting.told(model, found, criterion - criteria[chosen]));
    let mut models = models.collect::<Result<Vec<_>, _>>()?;
    let (mut model, mut found) = all.swap_remove(chosen);
    let before = models[chosen].misfit;
    let finer = Opened::finer(task, task.records, FINER);
    for _ in 0..CORRECTIONS {
        if model.correct(&found.x, &finer) {
            found = settled(&model, &found.x).unwrap_or(found);
        }
    }
    // What the law misses is a share of each motion, and all series keep one relative deviation; noise is taken from each series itself.
    if is_white(weights(&model, &found).inflation) {
        reweight(&mut model, &found);
    }
    let certain = Certain::about(model, found, &part(task.progress, [FITTED[2], 1.0]))?;
    if task.stopped.load(Ordering::Relaxed) {
        return Err(Error::Stopped);
    }
    let criterion = models[chosen].criterion;
    models[chosen] = fitting.told(&certain.model, &certain.found, criterion)?;
    let best = &models[chosen];
    if best.misfit > UNSETTLED * before && best.misfit > LEAVES {
        warnings.push(format!(
            "with finer time steps the model leaves {:.1} % of the records where it left {:.1} %: its values are not to be trusted; cut the records where the modes have \
             sunk into noise, or give more of them",
            100.0 * best.misfit,
            100.0 * before
        ));
    }
    if !at_odds {
        warnings.extend(fitting.doubted(Some((&certain.model, &certain.found))));
    }
    let left = Left { misfit: best.misfit, is_noise: certain.leaves_noise() };
    Ok(CoupledFit {
        warnings: [warnings, left.words(), one_sided(best)].concat(),
        estimates: without_knees(best, &left, certain.estimates()),
        combinations: certain.combinations(),
        models,
        chosen,
    })
}

/// Start frequencies, shapes and initial motions.
fn reference(task: &CoupledTask<'_>, opened: &Opened) -> Values {
    let n = task.modes.len();
    let mut values = Values {
        frequency: task.modes.iter().map(|m| m.parameters.frequency).collect(),
        damping_ratio: task.modes.iter().map(|m| m.parameters.damping_ratio).collect(),
        laws: Vec::new(),
        participation: Vec::new(),
        compliance: Vec::new(),
        slip_at_force: Vec::new(),
        shape_at_sensor: vec![1.0; n],
        shape_at_force: vec![1.0; n],
        initial: opened.initial.clone(),
    };
    values.shape_at_force = match task.shape_at_force {
        Some(shape) => shape.to_vec(),
        None if forced(task) => {
            shapes_at_force(task, opened, &values, 0..task.records.len()).unwrap_or(values.shape_at_force)
        }
        None => values.shape_at_force,
    };
    values
}

fn forced(task: &CoupledTask<'_>) -> bool {
    task.records[0].force.is_some()
}

struct Fitting<'a> {
    task: &'a CoupledTask<'a>,
    opened: &'a Opened,
    reference: Values,
}

type Fitted<'a> = (CoupledModel<'a>, Found);

impl<'a> Fitting<'a> {
    /// A model of one sharing with its minimum.
    fn found(
        &self,
        sharing: Sharing,
        starts: impl FnOnce(&Form) -> Vec<Vec<f64>>,
    ) -> Result<Fitted<'a>, Error> {
        let (task, opened) = (self.task, self.opened);
        let given =
            Given { seen: task.seen, forced: forced(task), shape_at_force: task.shape_at_force.is_some() };
        let form = Form::new(sharing, &self.reference, &opened.sizes, given);
        let starts = starts(&form);
        let how = (task.threads, task.stopped);
        let mut model = CoupledModel::new(form, &opened.records, opened.plans.clone(), task.quantity, how);
        let found = grown(&mut model, &starts)?;
        Ok((model, found))
    }

    /// A sentence on the load that does not go with its motion, if there is one.
    fn doubted(&self, best: Option<(&CoupledModel<'_>, &Found)>) -> Option<String> {
        let (model, found) = best.filter(|_| forced(self.task))?;
        let names: Vec<String> = self.task.records.iter().map(|r| r.name.clone()).collect();
        loads::words(model, found, &names)
    }

    /// What a model at its minimum says of all records, those kept out included.
    fn told(&self, model: &CoupledModel<'_>, found: &Found, criterion: f64) -> Result<FittedSharing, Error> {
        let unknown = || Error::Refused {
            finding: "the best values have no motion".into(),
            remedy: "check the units of the records",
        };
        let task = self.task;
        let values = model.form.values(&found.x).ok_or_else(unknown)?;
        let mut misfits = misfits(model, &found.x, task.records);
        let mut motions = (0..task.records.len())
            .map(|k| model.motions(&values, k))
            .collect::<Option<Vec<_>>>()
            .ok_or_else(unknown)?;
        let mut held_out = Vec::new();
        if !task.held_out.is_empty() {
            let opened = Opened::new(task, task.held_out);
            let form = Form::of_beginnings(
                model.form.sharing,
                &values,
                &opened.initial,
                &opened.sizes,
                forced(task),
            );
            let start = form.start(&[], &[], &[], 0.0);
            let how = (task.threads, task.stopped);
            let mut predicted =
                CoupledModel::new(form, &opened.records, opened.plans.clone(), task.quantity, how);
            let x = if start.is_empty() { start } else { near_beginning(&predicted, &start) };
            if model.is_corrected() {
                predicted.correct(&x, &Opened::finer(task, task.held_out, FINER));
            }
            held_out = self::misfits(&predicted, &x, task.held_out);
            let values = predicted.form.values(&x).ok_or_else(unknown)?;
            let more = (0..task.held_out.len()).map(|k| predicted.motions(&values, k));
            motions.extend(more.collect::<Option<Vec<_>>>().ok_or_else(unknown)?);
        }
        misfits.iter_mut().chain(&mut held_out).for_each(|m| m.relative = m.relative.min(f64::MAX));
        Ok(FittedSharing {
            sharing: model.form.sharing,
            unknowns: found.x.len(),
            criterion,
            misfit: mean(&misfits),
            held_out_misfit: (!held_out.is_empty()).then(|| mean(&held_out)),
            misfits,
            held_out,
            slip_ratios: model.slip_ratios(&found.x).ok_or_else(unknown)?,
            converged: found.converged,
            values,
            motions,
        })
    }
}

/// Initial displacements and velocities of records that a model predicts: these alone are fitted to the records.
fn near_beginning(model: &CoupledModel<'_>, start: &[f64]) -> Vec<f64> {
    let free: Vec<usize> = (0..start.len()).collect();
    near(model, start, &free, (30, 1e-5)).map_or_else(|| start.to_vec(), |found| found.x)
}

/// Relative misfit of each series.
fn misfits(model: &CoupledModel<'_>, x: &[f64], records: &[CoupledRecord]) -> Vec<Misfit> {
    let mut residuals = vec![0.0; model.count()];
    let known = model.evaluate(x, &mut residuals, None);
    let of = |(series, range): (&Series, Range<usize>)| {
        let count = range.len().max(1) as f64;
        let square = residuals[range].iter().map(|r| r * r).sum::<f64>() / count;
        let relative = if known { square.sqrt() * series.deviation / series.size } else { f64::INFINITY };
        Misfit { record: records[series.record].name.clone(), mode: series.mode, relative }
    };
    model.series.iter().zip(model.ranges()).map(of).collect()
}

fn mean(misfits: &[Misfit]) -> f64 {
    (misfits.iter().map(|m| m.relative * m.relative).sum::<f64>() / misfits.len().max(1) as f64).sqrt()
}

/// Schwarz's criterion N ln(cost/N) + k ln N of models that were fitted with the same standard deviations; k is the number of unknowns, and N the number of independent
/// residuals, as the correlation in the best model leaves them.
fn criteria(all: &[Fitted<'_>]) -> Vec<f64> {
    let count = all[0].0.count() as f64;
    let inflation = best_of(all).map_or(1.0, |(model, found)| weights(model, found).inflation);
    let own = (count / inflation).max(1.0);
    let of = |(_, found): &Fitted<'_>| {
        own * (found.cost / count).max((EXACT / FIRST).powi(2)).ln() + found.x.len() as f64 * own.ln()
    };
    all.iter().map(of).collect()
}

fn best_of<'f, 'a>(all: &'f [Fitted<'a>]) -> Option<(&'f CoupledModel<'a>, &'f Found)> {
    all.iter().min_by(|a, b| a.1.cost.total_cmp(&b.1.cost)).map(|(model, found)| (model, found))
}

/// Whether the best model so far leaves something that further joints could explain.
fn leaves_something(all: &[Fitted<'_>]) -> bool {
    best_of(all).is_none_or(|(model, found)| {
        let left = (found.cost / model.count() as f64).sqrt() * FIRST;
        left > LEAVES && !is_white(weights(model, found).inflation)
    })
}
