//! Joints of a structure from measured curves of several modes: `iwan.update`.

use std::collections::BTreeMap;

use iwan_fem::{Correction, Kinematic, NamedModes, Stiffness};
use iwan_input::{StructureFile, updated_structure};
use iwan_study::Error;
use iwan_study::update::{
    BlowTask, JointGroup, MeasuredBlow, MeasuredCurve, Update, UpdateTask, groups_that_move_alike, update,
    update_from_blows,
};
use pyo3::prelude::*;
use serde_json::json;

use crate::exchange::arguments::{Call, in_python};
use crate::exchange::array::Numbers;
use crate::exchange::errors::{computation, fem, value};
use crate::exchange::named::{self, ByName};
use crate::exchange::options::{thread_count, unknown};
use crate::exchange::work;
use crate::structures::structure::Structure;

/// The count that progress reaches at the end.
const PARTS: f64 = 1000.0;

/// A measured curve as Python passes it: mode, source, whether it is kept out, whether its frequency is a secant one; displacement,
/// frequency, damping ratio.
type Given<'py> = (String, String, bool, bool, Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>);

/// A blow as Python passes it: source, whether it is kept out, sampling interval, force, motions with the names of modes and outputs.
type GivenBlow<'py> = (String, bool, f64, Bound<'py, PyAny>, Vec<(String, Bound<'py, PyAny>)>);

/// A blow whose points are not yet assigned to the structure.
struct Read {
    source: String,
    held_out: bool,
    dt: f64,
    force: Vec<f64>,
    motions: Vec<(String, Vec<f64>)>,
}

/// What was found as a JSON text, and the text of the structure with the joints found, where that can be written.
#[pyfunction]
#[pyo3(signature = (structure, curves, *, groups, correct, undamped, blows, modes, quantity, threads, progress))]
#[expect(clippy::too_many_arguments, reason = "the keywords of one function of Python")]
pub(crate) fn _update<'py>(
    structure: &Bound<'py, Structure>,
    curves: Vec<Given<'py>>,
    #[pyo3(from_py_with = named::groups)] groups: Option<ByName<Vec<String>>>,
    #[pyo3(from_py_with = named::correct)] correct: ByName<Option<f64>>,
    #[pyo3(from_py_with = named::undamped)] undamped: bool,
    blows: Vec<GivenBlow<'py>>,
    #[pyo3(from_py_with = named::modes)] modes: Vec<String>,
    #[pyo3(from_py_with = named::quantity)] quantity: &str,
    #[pyo3(from_py_with = named::threads)] threads: Option<usize>,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<(String, Option<String>)> {
    let (py, loaded) = (structure.py(), structure.get().0.clone());
    let threads = thread_count(threads)?;
    let (mut measured, mut held_out) = (Vec::new(), Vec::new());
    for given in curves {
        let kept_out = given.2;
        if kept_out { &mut held_out } else { &mut measured }.push(curve(given)?);
    }
    let corrections = corrections(&loaded.file, correct.0)?;
    let laws = loaded.file.laws_to_seek().0;
    if laws.is_empty() {
        let message = "no joint has a four-parameter law to be found: add slip = [{ direction = ..., law = { k_t = ..., f_s = ..., \
                       chi = ..., beta = ... } }]";
        return Err(value(format!("{}: {message}", loaded.name())));
    }
    let groups =
        groups.map(|groups| named_groups(&loaded.file, &laws, groups.0.into_iter().collect())).transpose()?;
    let kinematic = match quantity {
        "acceleration" => Kinematic::Acceleration,
        "velocity" => Kinematic::Velocity,
        "displacement" => Kinematic::Displacement,
        other => {
            return Err(unknown("quantity", other, &["acceleration", "velocity", "displacement"]));
        }
    };
    let blows = blows.into_iter().map(blow).collect::<PyResult<Vec<_>>>()?;
    let this = loaded.clone();
    let found = work::watched(py, progress, move |control| {
        let structure = |source| Error::Structure { place: this.name().to_owned(), source };
        let named = this.named_modes(NamedModes::LOOKED_UP, control).map_err(structure)?;
        let blows =
            if blows.is_empty() { None } else { Some(placed(&this.file, &named, blows, modes, kinematic)?) };
        let modes: Vec<&str> = match &blows {
            Some(blows) => blows.modes.iter().map(String::as_str).collect(),
            None => measured.iter().map(|c: &MeasuredCurve| c.mode.as_str()).collect(),
        };
        let groups = match groups {
            Some(groups) => groups,
            None => groups_that_move_alike(&named, &laws, &modes)?,
        };
        let task = UpdateTask {
            named: &named,
            groups,
            corrections,
            viscous: !undamped,
            curves: measured,
            held_out,
            threads,
        };
        let progress = |share: f64| control.report((share * PARTS) as usize);
        let found = match &blows {
            Some(blows) => update_from_blows(&task, blows, &progress)?,
            None => update(&task, &progress)?,
        };
        let changes = this.file.changes(found.laws_of_joints(&task), found.factors_of_parts(&task));
        Ok((found, changes))
    })?;
    let (found, changes) = found.map_err(|error| refused(loaded.name(), &error))?;
    let text = updated_structure(loaded.source(), &changes).ok();
    Ok((told(&found), text))
}

fn curve((mode, source, _, secant, displacement, frequency, damping): Given<'_>) -> PyResult<MeasuredCurve> {
    let stiffness = if secant { Stiffness::Secant } else { Stiffness::FirstHarmonic };
    Ok(MeasuredCurve {
        displacement: Numbers::vector("displacement", &displacement)?,
        frequency: Numbers::vector("frequency", &frequency)?,
        damping_ratio: Numbers::vector("damping_ratio", &damping)?,
        mode,
        source,
        stiffness,
    })
}

fn blow((source, held_out, dt, force, motions): GivenBlow<'_>) -> PyResult<Read> {
    let motion = |(name, samples): (String, Bound<'_, PyAny>)| {
        let samples = Numbers::vector(&name, &samples)?;
        Ok((name, samples))
    };
    let motions = motions.into_iter().map(motion).collect::<PyResult<Vec<_>>>()?;
    Ok(Read { source, held_out, dt, force: Numbers::vector("force", &force)?, motions })
}

/// Blows whose points are outputs of the structure.
fn placed(
    file: &StructureFile,
    named: &NamedModes,
    blows: Vec<Read>,
    modes: Vec<String>,
    kinematic: Kinematic,
) -> Result<BlowTask, Error> {
    let structure = |place: &str| {
        let place = place.to_owned();
        move |source| Error::Structure { place, source }
    };
    let refused =
        |place: &str, finding: String, remedy| Error::Update { place: place.into(), finding, remedy };
    let of_file = |error: iwan_input::InputError| {
        refused("structure", error.message, "see the chapter on structures for [[load]] and [[output]]")
    };
    let chosen = named.chosen(&modes).map_err(structure("modes"))?;
    let outputs = file.recorded(named, &chosen).map_err(of_file)?;
    let load = file.forces(&named.assembled).map_err(of_file)?;
    let mut task = BlowTask { load, blows: Vec::new(), held_out: Vec::new(), modes };
    for Read { source, held_out, dt, force, motions } in blows {
        let mut points = Vec::new();
        for (name, samples) in motions {
            let found = outputs.iter().find(|output| output.name == name).cloned();
            let output = found.ok_or_else(|| {
                let known: Vec<&str> = outputs.iter().map(|output| output.name.as_str()).collect();
                let finding =
                    format!("there is no mode or output '{name}': choose from {}", known.join(", "));
                refused(&source, finding, "add an output to the structure, or a mode to modes")
            })?;
            points.push((output, samples));
        }
        let blow = MeasuredBlow { source, dt, force, points, kinematic };
        if held_out { &mut task.held_out } else { &mut task.blows }.push(blow);
    }
    Ok(task)
}

fn corrections(
    file: &StructureFile,
    wanted: Vec<(String, Option<f64>)>,
) -> PyResult<Vec<(String, Correction, Option<f64>)>> {
    let one = |(name, deviation): (String, Option<f64>)| {
        let part = file.part(&name).ok_or_else(|| {
            let known = file.parts().join(", ");
            value(format!("correct: the structure has no part '{name}': choose from {known}"))
        })?;
        Ok((name, part, deviation))
    };
    wanted.into_iter().map(one).collect()
}

fn named_groups(
    file: &StructureFile,
    laws: &[(usize, iwan_core::FourParameter)],
    wanted: BTreeMap<String, Vec<String>>,
) -> PyResult<Vec<JointGroup>> {
    let joints = &file.structure.joints;
    let known = || laws.iter().map(|(n, _)| joints[*n].name.as_str()).collect::<Vec<_>>().join(", ");
    let group = |(name, members): (String, Vec<String>)| {
        let found: Vec<(usize, iwan_core::FourParameter)> = members
            .iter()
            .map(|wanted| {
                let found = laws.iter().find(|(n, _)| joints[*n].name == *wanted).copied();
                found.ok_or_else(|| {
                    value(format!(
                        "groups: there is no joint '{wanted}' with a four-parameter law: choose from {}",
                        known()
                    ))
                })
            })
            .collect::<PyResult<_>>()?;
        let (_, law) = *found
            .first()
            .ok_or_else(|| value(format!("groups: '{name}' has no joint: choose from {}", known())))?;
        Ok(JointGroup { name, joints: found.into_iter().map(|(n, _)| n).collect(), law })
    };
    wanted.into_iter().map(group).collect()
}

/// All results as JSON text, from which `updating.py` makes Python values.
fn told(found: &Update) -> String {
    let told = json!({
        "groups": found.groups,
        "factors": found.factors,
        "viscous": found.viscous,
        "verdict": found.verdict,
        "corrections": found.corrections,
        "told": found.told,
        "next_modes": found.next_modes,
        "measure_next": found.measure_next,
        "front": found.front,
        "curves": found.curves,
        "blows": found.blows,
        "converged": found.converged,
    });
    in_python(&told.to_string(), Call::Other)
}

fn refused(name: &str, error: &Error) -> PyErr {
    match error {
        Error::Update { .. } => value(error.to_string()),
        Error::Structure { source, .. } => fem(name, source),
        other => computation(format!("{name}: {other}")),
    }
}
