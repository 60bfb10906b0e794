//! Which joints share a law, and which parts of the stiffness are corrected by a factor.

use iwan_fem::Correction;
use iwan_machine::listed;
use iwan_study::update::{JointGroup, groups_that_move_alike};

use super::args::UpdateArgs;
use crate::failure::Failure;
use crate::structures::Linear;

/// The groups of `--group`, else groups of joints that move alike in these modes.
pub(super) fn groups(
    linear: &Linear,
    args: &UpdateArgs,
    modes: &[&str],
) -> Result<(Vec<JointGroup>, Vec<String>), Failure> {
    let (laws, kept) = linear.file.laws_to_seek();
    if laws.is_empty() {
        let message = format!("{}: no joint has a four-parameter law to be found", linear.source);
        return Err(Failure::input(
            message,
            "add slip = [{ direction = ..., law = { k_t = ..., f_s = ..., chi = ..., beta = ... } }]",
        ));
    }
    if args.groups.is_empty() {
        let found = groups_that_move_alike(linear, &laws, modes);
        return found.map(|groups| (groups, kept)).map_err(|error| Failure::said(&linear.source, &error));
    }
    let one = |given: &String| {
        let (name, joints) = given.split_once('=').unwrap_or((given, given));
        let mut group: Option<JointGroup> = None;
        for wanted in joints.split(',').map(str::trim) {
            let found = laws.iter().find(|(n, _)| linear.file.structure.joints[*n].name == wanted);
            let (number, law) = found.ok_or_else(|| {
                let known: Vec<&str> =
                    laws.iter().map(|(n, _)| linear.file.structure.joints[*n].name.as_str()).collect();
                let message =
                    format!("--group {given}: there is no joint \"{wanted}\" with a four-parameter law");
                Failure::input(message, format!("choose from {}", listed(known)))
            })?;
            match &mut group {
                Some(group) => group.joints.push(*number),
                None => group = Some(JointGroup { name: name.to_owned(), joints: vec![*number], law: *law }),
            }
        }
        group
            .ok_or_else(|| Failure::input(format!("--group {given} names no joint"), "give NAME=JOINT,JOINT"))
    };
    Ok((args.groups.iter().map(one).collect::<Result<_, _>>()?, kept))
}

/// The corrections of `--correct`.
pub(super) fn corrections(
    linear: &Linear,
    args: &UpdateArgs,
) -> Result<Vec<(String, Correction, Option<f64>)>, Failure> {
    let one = |given: &String| {
        let (name, deviation) = match given.rsplit_once('=') {
            Some((name, sd)) => {
                let number = sd.parse::<f64>().ok().filter(|sd| sd.is_finite() && *sd > 0.0);
                let number = number.ok_or_else(|| {
                    let message = format!("--correct {given}: \"{sd}\" is no standard deviation > 0");
                    Failure::input(message, "give that of the factor's logarithm: 0.02 for two per cent")
                })?;
                (name, Some(number))
            }
            None => (given.as_str(), None),
        };
        let found = linear.file.part(name).ok_or_else(|| {
            let message = format!("--correct {given}: the structure has no such part");
            Failure::input(message, format!("choose from {}", listed(linear.file.parts())))
        })?;
        Ok((name.to_owned(), found, deviation))
    };
    args.corrections.iter().map(one).collect()
}
