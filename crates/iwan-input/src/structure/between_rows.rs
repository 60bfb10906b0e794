//! `[[joint]]` whose slips are rows of a matrix of relative displacements.

use std::collections::BTreeSet;

use iwan_fem::{RelativeSlip, Structure};

use super::ends::name;
use super::given::Combinations;
use super::joints::{JOINT_KEYS, SLIP_KEYS, StructureLaw, law};
use crate::error::InputError;
use crate::section::{Section, TablePlace};
use crate::text::InputText;

/// Reads the joints with the key `relative`, and adds them to the given matrices of the structure.
pub(super) fn read(
    source: &InputText,
    top: &Section<'_>,
    structure: &mut Structure,
    laws: &mut Vec<StructureLaw>,
) -> Result<(), InputError> {
    let mut names: BTreeSet<String> = structure.joints.iter().map(|joint| joint.name.clone()).collect();
    for (index, place) in top.tables("joint")?.into_iter().enumerate() {
        let section = Section::new(source, format!("joint {}", index + 1), place, JOINT_KEYS)?;
        if !section.has("relative") {
            continue;
        }
        let (section, name) = name(section, "joint", |given| names.contains(given))?;
        if let Some(key) = ["face", "patch", "motion"].into_iter().find(|key| section.has(key)) {
            let message =
                format!("{key} beside relative: the rows of the matrix say what moves against what");
            return Err(section.failure(key, &message, "remove one of the two"));
        }
        let rows = structure.given.as_ref().map(|given| given.rows.len());
        let combinations = Combinations::read(&section, &source.folder, "relative", rows)?;
        let slips = slips(source, &section, (&name, &combinations), laws)?;
        structure.given.iter_mut().for_each(|given| given.relative.extend(slips.clone()));
        names.insert(name);
    }
    Ok(())
}

/// The slips of one joint: for each entry of `slip` the rows that it names, or all rows.
fn slips(
    source: &InputText,
    section: &Section<'_>,
    (name, combinations): (&str, &Combinations),
    laws: &mut Vec<StructureLaw>,
) -> Result<Vec<RelativeSlip>, InputError> {
    let to_ground = section.optional_flag("to_ground")?.unwrap_or(false);
    let (mut all, mut taken) = (Vec::new(), BTreeSet::new());
    for (index, place) in section.tables("slip")?.into_iter().enumerate() {
        let title = format!("slip {} of {}", index + 1, section.title());
        let (own, rows) = rows_of(source, title, place, combinations)?;
        let law = law(source, &own)?;
        laws.extend(law.clone());
        for row in rows {
            if !taken.insert(row) {
                let message = format!("row {row} slips twice");
                return Err(own.failure("rows", &message, "name each row once"));
            }
            let terms = combinations.row(&own, "rows", row)?;
            let slip_law = law.as_ref().map(|law| law.law.clone());
            all.push(RelativeSlip { name: format!("{name} row {row}"), terms, law: slip_law, to_ground });
        }
    }
    if all.is_empty() {
        let remedy =
            "give slip = [{ law = { ... } }] for all rows, or slip = [{ rows = [1, 2], law = { ... } }, ...]";
        return Err(section.failure("slip", "it has no slip", remedy));
    }
    Ok(all)
}

fn rows_of<'a>(
    source: &'a InputText,
    title: String,
    place: TablePlace<'a>,
    combinations: &Combinations,
) -> Result<(Section<'a>, Vec<usize>), InputError> {
    let section = Section::new(source, title, place, SLIP_KEYS)?;
    if section.has("direction") {
        let message = "direction in a joint by rows: the rows of its matrix have their own";
        return Err(section.failure("direction", message, "give rows = [N, ...] in its place"));
    }
    let rows = if section.has("rows") {
        combinations.numbers(&section, "rows")?
    } else {
        (1..=combinations.len()).collect()
    };
    Ok((section, rows))
}
