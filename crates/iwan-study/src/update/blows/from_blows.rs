//! From blows on several points to joints, in one call.

use iwan_core::progress::part;
use iwan_core::{FourParameter, Progress};
use iwan_fem::{Adjustable, Basis, Correction, InCoordinates};
use iwan_ident::estimate::Interval;

use super::rings::Rings;
use super::settle::{Certain, Fitting, MISSED, MOST_EXCUSED};
use super::struck::{BlowTask, MeasuredBlow, Timed, modes_of};
use crate::error::Error;
use crate::update::fitted::{Estimated, JointUpdate, estimated};
use crate::update::model::{DAMPING_UNIT, coordinates, law};
use crate::update::outcome::{ComparedBlow, Update, in_words, names};
use crate::update::run::{MODES, update};
use crate::update::task::{UpdateTask, checked, model, starts};
use crate::update::verdict::StructureVerdict;

/// Finds the joints of a structure from blows. Transients of the reduced structure with all its modes are compared with the records of several
/// points, as complex amplitudes at the frequencies of the named modes in Hann windows. Where the task has curves as well, the search starts from the
/// joints that the curves give, else from those of the file and others near them.
///
/// # Errors
/// As [`update`]; [`Error::Update`] for records that cannot be used.
pub fn update_from_blows(
    task: &UpdateTask<'_>,
    blows: &BlowTask,
    progress: Progress<'_>,
) -> Result<Update, Error> {
    let failed = Error::structure("update");
    checked(task)?;
    let refused =
        |finding: &str, remedy| Error::Update { place: "update".into(), finding: finding.into(), remedy };
    if blows.blows.is_empty() || blows.modes.is_empty() {
        return Err(refused(
            "no record, or no mode to compare was given",
            "give a record and name its modes",
        ));
    }
    let assembled = &task.named.assembled;
    let modes: Vec<String> = blows.modes.iter().map(|name| name.replace('-', " ")).collect();
    let (numbers, frequencies) = modes_of(task.named, &modes)?;
    let timed = |all: &[MeasuredBlow]| -> Result<Vec<Timed>, Error> {
        all.iter().map(|blow| blow.timed(&frequencies, assembled.unknowns())).collect()
    };
    let (fitted, held_out) = (timed(&blows.blows)?, timed(&blows.held_out)?);
    let from_curves =
        if task.curves.is_empty() { None } else { Some(update(task, &part(progress, [0.0, 0.2]))?) };
    let highest = numbers.iter().copied().max().unwrap_or(0);
    let basis = MODES.max(2 * highest).min(assembled.unknowns());
    let reduced =
        assembled.reduce_observed(basis, Basis::default(), &part(progress, [0.2, 0.25])).map_err(&failed)?;
    let chosen: Vec<Correction> = task.corrections.iter().map(|c| c.1).collect();
    let adjustable = Adjustable::new(&reduced, &chosen).map_err(&failed)?;
    let place = |f: &[f64]| adjustable.in_coordinates(&reduced, f).map_err(&failed);
    let load = place(&blows.load)?;
    let outputs = |all: &[MeasuredBlow]| -> Result<Vec<Vec<InCoordinates>>, Error> {
        let of = |blow: &MeasuredBlow| blow.points.iter().map(|(o, _)| place(&o.coefficients)).collect();
        all.iter().map(of).collect()
    };
    let (own, others) = (outputs(&blows.blows)?, outputs(&blows.held_out)?);
    let beside = model(task, &adjustable, &[], &modes);
    let rings = |timed, outputs| {
        let given = (timed, load.clone(), outputs);
        Rings::new(beside.clone(), task.viscous, given, frequencies.clone(), task.threads)
    };
    let mut fitting = Fitting::new(rings(fitted, own));
    let all = beginnings(task, from_curves.as_ref(), &modes);
    let go_on = |share: f64| if progress(share).is_break() { Err(Error::Interrupted) } else { Ok(()) };
    go_on(0.25)?;
    let found = fitting.grown(&all, &|share| go_on(0.25 + 0.35 * share))?;
    go_on(0.6)?;
    let mut certain = fitting.certain(found, &|share| go_on(0.6 + 0.4 * share))?;
    let group_names: Vec<String> = task.groups.iter().map(|g| g.name.clone()).collect();
    let factors: Vec<String> = task.corrections.iter().map(|c| c.0.clone()).collect();
    let unknowns = names(&group_names, &factors, if task.viscous { &modes } else { &[] });
    let predicted = rings(held_out, others);
    let compared = [
        compared(&fitting.rings, (&all[0], &certain.found.x), &modes, false)?,
        compared(&predicted, (&all[0], &certain.found.x), &modes, true)?,
    ]
    .concat();
    let verdict = verdict(&compared, certain.is_noise);
    if !verdict.adequate {
        // Joints that do not describe the blows have best values, but these are not the structure's: all intervals are open.
        certain.intervals.fill(Interval::default());
    }
    let place = |k: usize| fitting.rings.beside.first_factor() + k;
    let of =
        |j: usize, value: &dyn Fn(f64) -> f64| estimated(certain.found.x[j], certain.intervals[j], value);
    let viscous = fitting.rings.beside.first_viscous();
    let damped = modes.iter().enumerate().filter(|_| task.viscous);
    let base = from_curves.unwrap_or_else(nothing);
    Ok(Update {
        groups: joints(task, &certain),
        laws: certain.found.x[..fitting.rings.beside.first_factor()]
            .chunks_exact(4)
            .filter_map(law)
            .collect(),
        factors: factors.iter().enumerate().map(|(k, n)| (n.clone(), of(place(k), &f64::exp))).collect(),
        viscous: damped.map(|(n, mode)| (mode.clone(), of(viscous + n, &|x| DAMPING_UNIT * x))).collect(),
        told: in_words(&certain.told, &certain.free, &unknowns),
        verdict,
        blows: compared,
        converged: certain.found.converged,
        ..base
    })
}

/// Start values of the search: the joints that the curves gave, or those of the file and others near them.
fn beginnings(task: &UpdateTask<'_>, from_curves: Option<&Update>, modes: &[String]) -> Vec<Vec<f64>> {
    let mut all = starts(task, &[], modes.len());
    let Some(found) = from_curves else { return all };
    let mut x = all.swap_remove(0);
    for (x, law) in x.chunks_exact_mut(4).zip(&found.laws) {
        x.copy_from_slice(&coordinates(law));
    }
    let first = 4 * found.laws.len();
    found.factors.iter().enumerate().for_each(|(k, (_, factor))| x[first + k] = factor.value.ln());
    let first = first + found.factors.len();
    for (k, mode) in modes.iter().enumerate().filter(|_| task.viscous) {
        if let Some((_, ratio)) = found.viscous.iter().find(|(name, _)| name == mode) {
            x[first + k] = ratio.value / DAMPING_UNIT;
        }
    }
    vec![x]
}

/// An empty update, without curves.
fn nothing() -> Update {
    Update {
        groups: Vec::new(),
        laws: Vec::<FourParameter>::new(),
        factors: Vec::new(),
        viscous: Vec::new(),
        curves: Vec::new(),
        told: Vec::new(),
        verdict: StructureVerdict {
            adequate: true,
            departures: Vec::new(),
            systematic: Vec::new(),
            hints: Vec::new(),
            in_words: String::new(),
        },
        corrections: Vec::new(),
        next_modes: Vec::new(),
        measure_next: String::new(),
        front: Vec::new(),
        blows: Vec::new(),
        converged: true,
    }
}

fn joints(task: &UpdateTask<'_>, certain: &Certain) -> Vec<JointUpdate> {
    let all = &task.named.assembled.structure().joints;
    let one = |(n, group): (usize, &crate::update::group::JointGroup)| {
        let of = |k: usize, value: &dyn Fn(f64) -> f64| -> Estimated {
            estimated(certain.found.x[4 * n + k], certain.intervals[4 * n + k], value)
        };
        JointUpdate {
            name: group.name.clone(),
            joints: group.joints.iter().map(|j| all[*j].name.clone()).collect(),
            k_t: of(0, &f64::exp),
            f_s: of(1, &f64::exp),
            chi: of(2, &|x| x),
            beta: of(3, &|x| x / (1.0 - x)),
            slip_ratio: certain.slip_ratios[n],
        }
    };
    task.groups.iter().enumerate().map(one).collect()
}

/// Every gate (one mode at one point) with the measured and the computed amplitudes.
fn compared(
    rings: &Rings<'_>,
    (before, after): (&[f64], &[f64]),
    modes: &[String],
    held_out: bool,
) -> Result<Vec<ComparedBlow>, Error> {
    let first = rings.misfits(before);
    let misfits = rings.misfits(after).ok_or_else(|| Error::Update {
        place: "prediction".into(),
        finding: "the structure has no motion under this blow".into(),
        remedy: "leave the blow out",
    })?;
    let mut all = Vec::new();
    for (k, blow) in rings.blows.iter().enumerate() {
        let Some(rung) = rings.rung(after, k) else { continue };
        for (g, gate) in blow.gates.iter().enumerate() {
            let sizes = |pairs: &[f64]| -> Vec<f64> {
                let (re, im) = pairs.split_at(pairs.len() / 2);
                // An entry of a gate is √(length/3) times the amplitude; this factor turns it back.
                let unit = (3.0 / gate.sums.length() as f64).sqrt();
                re.iter().zip(im).map(|(re, im)| unit * re.hypot(*im)).collect()
            };
            let measured = sizes(&gate.measured);
            let half = 0.5 * gate.sums.length() as f64 * blow.step * blow.every as f64;
            all.push(ComparedBlow {
                source: blow.source.clone(),
                point: gate.name.clone(),
                mode: modes[gate.mode].clone(),
                held_out,
                before: first.as_ref().map(|all| all[k][g]),
                after: misfits[k][g],
                time: (0..measured.len()).map(|n| half * (n + 1) as f64).collect(),
                measured,
                computed: sizes(&rung.amplitudes[g]),
            });
        }
    }
    Ok(all)
}

/// The verdict of the blows on the structure.
fn verdict(compared: &[ComparedBlow], is_noise: bool) -> StructureVerdict {
    let fitted = compared.iter().filter(|blow| !blow.held_out);
    let worst = fitted.max_by(|a, b| a.after.total_cmp(&b.after));
    let limit = if is_noise { MOST_EXCUSED } else { MISSED };
    // A misfit that is not a number counts as missed.
    let missed = worst.filter(|worst| worst.after.is_nan() || worst.after > limit);
    let in_words = match (missed, worst) {
        (Some(worst), _) => format!(
            "the structure with the best joints leaves the records: {:.1} % of {} at {} in {} is missed, {}; the intervals of all unknowns are left open",
            100.0 * worst.after,
            worst.mode,
            worst.point,
            worst.source,
            if is_noise { "which is more than noise excuses" } else { "and what is left is not noise" }
        ),
        (None, Some(worst)) => format!(
            "the structure with these joints tells all records: at most {:.2} % is missed ({} at {} in {})",
            100.0 * worst.after,
            worst.mode,
            worst.point,
            worst.source
        ),
        (None, None) => String::new(),
    };
    StructureVerdict {
        adequate: missed.is_none(),
        departures: Vec::new(),
        systematic: Vec::new(),
        hints: Vec::new(),
        in_words,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_excuses_no_blow_that_is_missed_by_a_third() {
        let blow = |after: f64| ComparedBlow {
            source: "hit".into(),
            point: "tip".into(),
            mode: "bending 1".into(),
            held_out: false,
            before: None,
            after,
            time: vec![],
            measured: vec![],
            computed: vec![],
        };
        assert!(verdict(&[blow(0.01), blow(0.2)], true).adequate);
        for (missed, is_noise) in [(0.2, false), (47.0, true), (f64::NAN, true)] {
            let verdict = verdict(&[blow(0.01), blow(missed)], is_noise);
            assert!(!verdict.adequate && verdict.in_words.contains("left open"), "{}", verdict.in_words);
        }
    }
}
