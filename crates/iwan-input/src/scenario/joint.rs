//! `[[joint]]`: a joint that several modes share.

use iwan_sim::{JointLaw, SharedJoint, SimulationError, StuckRange, check_coupled};

use crate::error::InputError;
use crate::section::{Section, TablePlace, nearest, plain};
use crate::text::InputText;
use crate::written_law::WrittenLaw;
use iwan_sim::{Mode, Settings};

use super::mode::ScenarioMode;

/// Keys of a joint.
pub(crate) const KEYS: &[&str] = &["name", "law", "participation", "compliance", "slip_at_force"];

/// A joint, and its law as the file writes it.
#[derive(Debug, Clone, PartialEq)]
pub struct ScenarioJoint {
    /// The joint for the simulation.
    pub joint: SharedJoint,
    /// The joint's law as the file writes it.
    pub law: WrittenLaw,
}

/// Reads and checks the joints that these modes share; empty where the key is missing.
pub(super) fn read(
    source: &InputText,
    top: &Section<'_>,
    modes: &[ScenarioMode],
) -> Result<Vec<ScenarioJoint>, InputError> {
    let places = top.tables("joint")?;
    let sections = places
        .iter()
        .enumerate()
        .map(|(n, place)| Section::new(source, format!("joint {}", n + 1), place.clone(), KEYS))
        .collect::<Result<Vec<_>, _>>()?;
    let names = names(&sections, modes)?;
    let titled = sections.into_iter().zip(&names);
    let sections: Vec<Section<'_>> =
        titled.map(|(section, name)| section.renamed(format!("joint \"{name}\""))).collect();
    let mut joints = Vec::new();
    for (n, section) in sections.iter().enumerate() {
        let (law, shared) = read_law(source, section)?;
        let joint = SharedJoint {
            participation: participation(source, section, modes)?,
            compliance: compliance(source, section, (&names, n))?,
            slip_at_force: finite(section, "slip_at_force", section.number_or("slip_at_force", 0.0)?)?,
            ..SharedJoint::new(names[n].clone(), shared, Vec::new(), names.len())
        };
        joints.push(ScenarioJoint { joint, law });
    }
    make_symmetric(&mut joints, &sections)?;
    Ok(joints)
}

/// Checks that modes and joints together describe a structure, and that the method can step it.
pub(super) fn check(
    source: &InputText,
    top: &Section<'_>,
    (modes, joints): (&[Mode], &[ScenarioJoint]),
    settings: &Settings,
) -> Result<(), InputError> {
    let shared: Vec<SharedJoint> = joints.iter().map(|j| j.joint.clone()).collect();
    match check_coupled(modes, &shared, settings) {
        Ok(()) => Ok(()),
        Err(error) => refused(source, top, &shared, &error),
    }
}

/// Checks that modes and joints together describe a structure that can vibrate steadily.
pub(super) fn check_steady(
    source: &InputText,
    top: &Section<'_>,
    modes: &[Mode],
    joints: &[SharedJoint],
) -> Result<(), InputError> {
    match StuckRange::of_coupled(modes, joints) {
        Ok(_) => Ok(()),
        Err(error) => refused(source, top, joints, &error),
    }
}

/// The error for modes and joints that the library refuses, at their place in the file.
fn refused(
    source: &InputText,
    top: &Section<'_>,
    shared: &[SharedJoint],
    error: &SimulationError,
) -> Result<(), InputError> {
    let remedy = "change this joint or this mode, or choose kind = \"newmark\"";
    let SimulationError::Joint { joint, source: inner } = error else {
        return Err(top.failure("joint", &error.to_string(), remedy));
    };
    let places = top.tables("joint")?;
    let at = shared.iter().position(|j| j.name == *joint);
    match at.and_then(|n| places.get(n)) {
        Some(place) => {
            let section = Section::any(source, format!("joint \"{joint}\""), place.clone());
            Err(section.failure("compliance", &inner.to_string(), "change these numbers of the joint"))
        }
        None => Err(top.failure("joint", &error.to_string(), remedy)),
    }
}

/// Names of the joints, which must differ from each other and from those of modes and points, because columns are named after all of them.
fn names(sections: &[Section<'_>], modes: &[ScenarioMode]) -> Result<Vec<String>, InputError> {
    let mut names: Vec<String> = Vec::new();
    for (n, section) in sections.iter().enumerate() {
        let name = section.optional_name("name")?.unwrap_or_else(|| format!("joint {}", n + 1));
        let taken =
            modes.iter().any(|m| m.mode.name == name || m.mode.outputs.iter().any(|p| p.name == name));
        if taken || names.contains(&name) {
            let message =
                format!("name = \"{name}\" is the name of a mode, a point or another joint already");
            return Err(section.failure("name", &message, "give every joint a name of its own"));
        }
        names.push(name);
    }
    Ok(names)
}

fn read_law(source: &InputText, section: &Section<'_>) -> Result<(WrittenLaw, JointLaw), InputError> {
    match section.optional_table("law")? {
        Some(place) => WrittenLaw::read(source, format!("law of {}", section.title()), place),
        None => Err(section.failure(
            "law",
            "the key `law` is missing",
            "add law = { k_t = NUMBER, f_s = NUMBER, chi = NUMBER, beta = NUMBER }, in force and slip",
        )),
    }
}

fn finite(section: &Section<'_>, key: &str, value: f64) -> Result<f64, InputError> {
    if value.is_finite() {
        return Ok(value);
    }
    let message = format!("{key} = {} is out of range: must be a finite number", plain(value));
    Err(section.failure(key, &message, &format!("give {key} a finite value")))
}

/// A table of numbers with names as keys: returns a number for each name in `known`, 0 where the table does not have it.
fn by_name(
    source: &InputText,
    section: &Section<'_>,
    (key, place): (&str, TablePlace<'_>),
    (what, known): (&str, &[&str]),
) -> Result<Vec<Option<f64>>, InputError> {
    let (table, entries) = Section::entries(source, &format!("{key} of {}", section.title()), place)?;
    let mut values = vec![None; known.len()];
    for (name, value) in entries {
        let Some(index) = known.iter().position(|k| *k == name) else {
            let message = format!("there is no {what} \"{name}\"");
            let remedy = match nearest(&name, known) {
                Some(near) => format!("did you mean \"{near}\"? There are {}", known.join(", ")),
                None => format!("name one of {}", known.join(", ")),
            };
            return Err(table.failure(&name, &message, &remedy));
        };
        values[index] = Some(finite(&table, &name, value)?);
    }
    Ok(values)
}

fn participation(
    source: &InputText,
    section: &Section<'_>,
    modes: &[ScenarioMode],
) -> Result<Vec<f64>, InputError> {
    let remedy = "add participation = { \"MODE\" = NUMBER, ... }: the joint's slip in a unit displacement of each mode";
    let Some(place) = section.optional_table("participation")? else {
        return Err(section.failure("participation", "the key `participation` is missing", remedy));
    };
    let known: Vec<&str> = modes.iter().map(|m| m.mode.name.as_str()).collect();
    let given = by_name(source, section, ("participation", place), ("mode", &known))?;
    let values: Vec<f64> = given.into_iter().map(|b| b.unwrap_or(0.0)).collect();
    if values.iter().all(|b| *b == 0.0) {
        let message = "participation names no mode that moves the joint";
        return Err(section.failure("participation", message, remedy));
    }
    Ok(values)
}

/// A row of the compliance matrix. A single number is the compliance of the joint itself; a table has names of joints as keys. Entries that
/// are not given are NaN until [`make_symmetric`] fills them.
fn compliance(
    source: &InputText,
    section: &Section<'_>,
    (names, own): (&[String], usize),
) -> Result<Vec<f64>, InputError> {
    let mut row = vec![f64::NAN; names.len()];
    match section.optional_table("compliance") {
        Ok(Some(place)) => {
            let known: Vec<&str> = names.iter().map(String::as_str).collect();
            let given = by_name(source, section, ("compliance", place), ("joint", &known))?;
            row.iter_mut().zip(given).for_each(|(rho, given)| *rho = given.unwrap_or(f64::NAN));
        }
        Ok(None) => {}
        // The value is no table: it is the joint's own number, or an error.
        Err(_) => row[own] = finite(section, "compliance", section.number("compliance")?)?,
    }
    if row[own].is_nan() {
        row[own] = 0.0;
    }
    if row[own] < 0.0 {
        let message =
            format!("compliance = {} is out of range: must be a finite number >= 0", plain(row[own]));
        let remedy = "give the slip from a unit force through the modes that are left out, or leave it out";
        return Err(section.failure("compliance", &message, remedy));
    }
    Ok(row)
}

/// Makes the compliance matrix symmetric: either of two joints may give the compliance between them; where both do, the values must agree.
fn make_symmetric(joints: &mut [ScenarioJoint], sections: &[Section<'_>]) -> Result<(), InputError> {
    for i in 0..joints.len() {
        for l in 0..i {
            let pair = [joints[i].joint.compliance[l], joints[l].joint.compliance[i]];
            let value = match pair {
                [a, b] if a.is_nan() && b.is_nan() => 0.0,
                [a, b] if a.is_nan() => b,
                [a, b] if b.is_nan() || a == b => a,
                [a, b] => {
                    let (one, other) = (&joints[i].joint.name, &joints[l].joint.name);
                    let message = format!(
                        "compliance to \"{other}\" is {}, but that of \"{other}\" to \"{one}\" is {}: they must be the same",
                        plain(a),
                        plain(b)
                    );
                    return Err(sections[i].failure(
                        "compliance",
                        &message,
                        "correct one of them, or give it once",
                    ));
                }
            };
            (joints[i].joint.compliance[l], joints[l].joint.compliance[i]) = (value, value);
        }
    }
    Ok(())
}
