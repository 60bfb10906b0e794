//! From curves to joints, in one call.

use iwan_core::Progress;
use iwan_core::progress::part;
use iwan_fem::{Adjustable, Assembled, Basis, Correction, Stiffness};
use iwan_ident::estimate::Interval;

use super::explain::explanations;
use super::fitted::{Estimated, Fit, JointUpdate};
use super::further::{front, in_words, next_modes};
use super::group::JointGroup;
use super::measured::Point;
use super::mistakes::{hints, other_length, refuse};
use super::model::{Beside, DAMPING_UNIT, Said};
use super::outcome::{ComparedCurve, Update, names, told};
use super::predicted::{Asked, Spread, held_against, spread};
use super::task::{Placed, UpdateTask, checked, model, modes_of, placed, starts};
use super::verdict::{Departure, Passing, StructureVerdict, appended, departures};
use crate::error::Error;

/// Least number of modes in the basis of the reduced structure, beside the attachment vectors; the basis also has as many modes above the highest
/// measured one as up to it. 40 modes of the paper's beam reach to 10 kHz; the frequencies of its first modes are then within 1e-6 under a correction
/// of 3 %.
pub(super) const MODES: usize = 40;
/// Number of points on the front of compromises.
const FRONT: usize = 30;
/// Finds the joints of a structure from curves of several modes.
///
/// # Errors
/// [`Error::Update`] for curves or groups that cannot be used; [`Error::Structure`]; [`Error::Identification`] where the structure has curves at no
/// start;
/// [`Error::Interrupted`].
pub fn update(task: &UpdateTask<'_>, progress: Progress<'_>) -> Result<Update, Error> {
    let failed = Error::structure("update");
    let assembled = &task.named.assembled;
    if task.curves.is_empty() {
        return Err(Error::Update {
            place: "update".into(),
            finding: "no curve was given".into(),
            remedy: "give curves of at least one mode",
        });
    }
    let measured = placed(task, &task.curves)?;
    let held_out = placed(task, &task.held_out)?;
    checked(task)?;
    refuse(task.named, &measured)?;
    refuse(task.named, &held_out)?;
    let highest = measured.iter().chain(&held_out).map(|p| p.mode).max().unwrap_or(0);
    let basis = MODES.max(2 * highest).min(assembled.unknowns());
    let reduced =
        assembled.reduce_observed(basis, Basis::default(), &part(progress, [0.0, 0.2])).map_err(&failed)?;
    let chosen: Vec<Correction> = task.corrections.iter().map(|c| c.1).collect();
    let adjustable = Adjustable::new(&reduced, &chosen).map_err(&failed)?;
    let modes = modes_of(&measured);
    let model = model(task, &adjustable, &measured, &modes);
    let go_on = |share: f64| if progress(share).is_break() { Err(Error::Interrupted) } else { Ok(()) };
    go_on(0.25)?;
    let group_names: Vec<String> = task.groups.iter().map(|g| g.name.clone()).collect();
    let factors: Vec<String> = task.corrections.iter().map(|c| c.0.clone()).collect();
    let unknowns = names(&group_names, &factors, if task.viscous { &modes } else { &[] });
    let starts = starts_with_curves(task, &model, &measured, modes.len())?;
    let mut fit = Fit::new(model, &starts)?;
    go_on(0.5)?;
    let mut intervals = fit.intervals(task.threads)?;
    go_on(0.8)?;
    let found = joints(task, assembled, &fit, &intervals)?;
    let verdict = verdict(task, &fit, &measured, &found)?;
    let mut told = told(&fit, &unknowns);
    if !verdict.adequate {
        // Joints that do not describe the curves have best values, but these are not the structure's: all intervals are open.
        intervals.fill(Interval::default());
        for combination in &mut told {
            combination.deviation = None;
        }
    }
    let corrections =
        if verdict.adequate { Vec::new() } else { explanations(task, &fit, &reduced, &measured) };
    go_on(0.85)?;
    let front = front(&fit, FRONT);
    let closed = |interval: &Interval| interval.low.is_some() && interval.high.is_some();
    let open: Vec<usize> = (0..fit.model.first_factor()).filter(|j| !closed(&intervals[*j])).collect();
    let adequate = verdict.adequate;
    let next_modes = if adequate { next_modes(&fit, task.named, &group_names, &open) } else { Vec::new() };
    Ok(Update {
        groups: joints(task, assembled, &fit, &intervals)?,
        laws: fit.laws(),
        factors: factors.iter().enumerate().map(|(k, n)| (n.clone(), fit.factor(k, &intervals))).collect(),
        viscous: viscous(task, &fit, &intervals, &modes),
        curves: compared((task, &fit), &measured, &held_out, (&intervals, &unknowns, adequate))?,
        told,
        verdict,
        corrections,
        measure_next: in_words(adequate, &open, &next_modes),
        next_modes,
        front,
        blows: Vec::new(),
        converged: fit.found.converged,
    })
}

fn verdict(
    task: &UpdateTask<'_>,
    fit: &Fit<'_>,
    measured: &[Placed<'_>],
    found: &[JointUpdate],
) -> Result<StructureVerdict, Error> {
    let said = said_of_all(fit)?;
    let computed = Passing::computed(measured.iter().map(|p| p.points.len()));
    let beyond = |passing| {
        let pairs = measured.iter().zip(&said);
        pairs.flat_map(|(p, said)| departures(&p.curve.mode, &p.points, said, passing)).collect()
    };
    let missed: Vec<Departure> = beyond(Passing::REPEATS);
    let suspected = if missed.is_empty() {
        other_length(&task.groups, found)
    } else {
        let x = starts(task, measured, modes_of(measured).len()).remove(0);
        hints(task.named, measured, &before(&fit.model, &x, measured))
    };
    Ok(StructureVerdict::new(missed, beyond(computed), suspected))
}

/// The structure's own curves with the joints of its file, at the measured points; none where they cannot be computed.
fn before(model: &Beside<'_>, x: &[f64], measured: &[Placed<'_>]) -> Vec<Option<Vec<Said>>> {
    let of = |placed: &Placed<'_>| {
        let q: Vec<f64> = placed.points.iter().map(|p| p.displacement).collect();
        model.said(&model.adjusted(x)?, x, (placed.mode, None, placed.curve.stiffness), &q)
    };
    measured.iter().map(of).collect()
}

/// Start values; at the first of them the structure has curves at the measured amplitudes.
fn starts_with_curves(
    task: &UpdateTask<'_>,
    model: &Beside<'_>,
    measured: &[Placed<'_>],
    modes: usize,
) -> Result<Vec<Vec<f64>>, Error> {
    let mut all = starts(task, measured, modes);
    let Some(first) = all.iter().position(|x| model.said_of_all(x).is_some()) else {
        let before = before(model, &all[0], measured);
        let slides = measured.iter().zip(&before).filter(|(_, said)| said.is_none());
        let mut slides =
            slides.map(|(p, _)| (p.curve.mode.as_str(), p.points[p.points.len() - 1].displacement));
        let (mode, q) = slides.next_back().unwrap_or(("the measured modes", f64::NAN));
        let hints = hints(task.named, measured, &before);
        return Err(Error::Update {
            place: "update".into(),
            finding: format!(
                "with the joints of the file, and with others near them, no static load holds {mode} at the modal displacement {q:.3e}: all its joints \
                 slide there{}",
                appended(&hints)
            ),
            remedy: "check the unit of the displacement, leave out the largest amplitudes, or give the joints of the file a larger f_s",
        });
    };
    all.swap(0, first);
    Ok(all)
}

fn said_of_all(fit: &Fit<'_>) -> Result<Vec<Vec<Said>>, Error> {
    fit.model.said_of_all(&fit.found.x).ok_or_else(|| Error::Update {
        place: "update".into(),
        finding: "the joints found have no curves".into(),
        remedy: "leave out the largest amplitudes",
    })
}

fn joints(
    task: &UpdateTask<'_>,
    assembled: &Assembled,
    fit: &Fit<'_>,
    intervals: &[Interval],
) -> Result<Vec<JointUpdate>, Error> {
    let said = said_of_all(fit)?;
    let one = |(n, group): (usize, &JointGroup)| {
        let ratio = said.iter().flatten().map(|s| s.slip_ratios[n]).fold(0.0, f64::max);
        let mut joint = fit.joint(n, intervals, ratio);
        joint.name.clone_from(&group.name);
        joint.joints = group.joints.iter().map(|j| assembled.structure().joints[*j].name.clone()).collect();
        joint
    };
    Ok(task.groups.iter().enumerate().map(one).collect())
}

fn viscous(
    task: &UpdateTask<'_>,
    fit: &Fit<'_>,
    intervals: &[Interval],
    modes: &[String],
) -> Vec<(String, Estimated)> {
    let all = modes.iter().enumerate().filter(|_| task.viscous);
    all.map(|(n, mode)| (mode.clone(), fit.viscous(n, intervals))).collect()
}

/// Measured curves, compared with those of the structure before and after the update.
fn compared(
    (task, fit): (&UpdateTask<'_>, &Fit<'_>),
    measured: &[Placed<'_>],
    held_out: &[Placed<'_>],
    (intervals, unknowns, adequate): (&[Interval], &[String], bool),
) -> Result<Vec<ComparedCurve>, Error> {
    let before = starts(task, measured, modes_of(measured).len()).remove(0);
    let mut undamped = before.clone();
    undamped[fit.model.first_viscous()..].fill(0.0);
    let mut all = Vec::new();
    for (placed, held) in measured.iter().map(|p| (p, false)).chain(held_out.iter().map(|p| (p, true))) {
        let own =
            fit.model.curves.iter().find(|curve| curve.mode == placed.mode).and_then(|curve| curve.viscous);
        let with = (placed.mode, own, placed.curve.stiffness);
        let after = said_with(fit, &fit.found.x, with, &placed.points)?;
        // A mode that was not measured gets the mean of the other modes' viscous damping.
        let x = &fit.found.x[fit.model.first_viscous()..];
        let mean = if own.is_none() && !x.is_empty() {
            DAMPING_UNIT * x.iter().sum::<f64>() / x.len() as f64
        } else {
            0.0
        };
        // With the joints of the file parts may slide freely at these amplitudes; the curve before the update is then missing.
        let first =
            said_with(fit, &undamped, (placed.mode, None, placed.curve.stiffness), &placed.points).ok();
        let of = |said: Option<&Vec<Said>>, get: &dyn Fn(&Said) -> f64| -> Vec<f64> {
            said.map(|said| said.iter().map(get).collect()).unwrap_or_default()
        };
        let frequency_after = of(Some(&after), &|s| s.frequency);
        let damping_ratio_after = of(Some(&after), &|s| s.log_damping.exp() + mean);
        let mode = placed.curve.mode.replace('-', " ");
        let spread = if held || !adequate {
            let asked = Asked {
                mode: &mode,
                with,
                points: &placed.points,
                said: &after,
                guessed: mean,
                viscous: task.viscous,
                adequate,
            };
            spread(fit, intervals, unknowns, asked)
        } else {
            Spread {
                frequency: of(Some(&after), &|s| fit.told.deviation(&s.frequency_by)),
                log_damping: of(Some(&after), &|s| fit.told.deviation(&s.log_damping_by)),
                not_predicted: Vec::new(),
            }
        };
        let prediction =
            held.then(|| held_against(&placed.points, &frequency_after, &damping_ratio_after, &spread));
        all.push(ComparedCurve {
            mode,
            source: placed.curve.source.clone(),
            held_out: held,
            displacement: placed.points.iter().map(|p| p.displacement).collect(),
            frequency: placed.points.iter().map(|p| p.frequency).collect(),
            damping_ratio: placed.points.iter().map(|p| p.log_damping.exp()).collect(),
            frequency_before: of(first.as_ref(), &|s| s.frequency),
            damping_ratio_before: of(first.as_ref(), &|s| s.log_damping.exp()),
            frequency_after,
            damping_ratio_after,
            frequency_sd: spread.frequency,
            log_damping_sd: spread.log_damping,
            prediction,
        });
    }
    Ok(all)
}

fn said_with(
    fit: &Fit<'_>,
    x: &[f64],
    with: (usize, Option<usize>, Stiffness),
    points: &[Point],
) -> Result<Vec<Said>, Error> {
    let q: Vec<f64> = points.iter().map(|p| p.displacement).collect();
    let said = fit.model.adjusted(x).and_then(|adjusted| fit.model.said(&adjusted, x, with, &q));
    said.ok_or_else(|| Error::Update {
        place: "prediction".into(),
        finding: "no static load holds these amplitudes".into(),
        remedy: "leave out the largest amplitudes",
    })
}
