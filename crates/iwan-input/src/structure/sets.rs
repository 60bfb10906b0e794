//! `[[set]]`: further sets, by numbers or by place, and the look-up of sets by name.

use iwan_machine::listed;
use std::collections::BTreeMap;

use iwan_fem::mesh::Mesh;

use crate::error::InputError;
use crate::section::{Section, TableKind, nearest};
use crate::text::InputText;

/// The kinds of sets and their keys.
pub(super) const KINDS: &[TableKind] = &[
    TableKind { name: "nodes", keys: &["name", "numbers"] },
    TableKind { name: "elements", keys: &["name", "numbers"] },
    TableKind { name: "box", keys: &["name", "low", "high"] },
];

/// Distance from a box, as a share of the diagonal of the mesh, within which nodes still belong to the box: rounding of computed
/// coordinates. Nodes of a file with seven digits may lie farther off a plane, and then need a wider box.
const ROUNDING: f64 = 1e-9;

/// Adds the sets of the file to those of the mesh.
pub(super) fn read(source: &InputText, top: &Section<'_>, mesh: &mut Mesh) -> Result<(), InputError> {
    for (index, place) in top.tables("set")?.into_iter().enumerate() {
        let (section, kind) = Section::kind(source, format!("set {}", index + 1), place, KINDS, None)?;
        let name = section.name("name")?;
        let section = section.renamed(format!("set \"{name}\""));
        let sets = if kind.name == "elements" { &mesh.element_sets } else { &mesh.node_sets };
        if sets.contains_key(&name) {
            let message = "there is a set of this name already";
            return Err(section.failure("name", message, "give every set a name of its own"));
        }
        let members = match kind.name {
            "box" => inside(&section, mesh)?,
            "nodes" => numbered(&section, "node", mesh.node_labels.iter().copied())?,
            _ => numbered(&section, "element", mesh.elements.iter().map(|e| e.label))?,
        };
        let sets = if kind.name == "elements" { &mut mesh.element_sets } else { &mut mesh.node_sets };
        sets.insert(name, members);
    }
    single_nodes(source, top, mesh)
}

/// Number in the mesh of the node that a file calls `name`: its number, or `INSTANCE.NUMBER` for a node of an instance.
fn labelled(name: &str, mesh: &Mesh) -> Option<u64> {
    let (instance, number) = match name.rsplit_once('.') {
        Some((instance, number)) if !mesh.node_sets.contains_key(name) => (Some(instance), number),
        _ => (None, name),
    };
    let shift = match instance {
        Some(instance) => *mesh.instances.iter().find(|known| known.0.eq_ignore_ascii_case(instance))?.1,
        None => 0,
    };
    number.parse::<u64>().ok()?.checked_add(shift)
}

/// Adds a set of one node wherever a table names a node by its number, `nodes = "17"` or `nodes = "Plate-1.17"`.
fn single_nodes(source: &InputText, top: &Section<'_>, mesh: &mut Mesh) -> Result<(), InputError> {
    let mut index: Option<BTreeMap<u64, usize>> = None;
    for word in ["joint", "tie", "support", "lump", "load", "output"] {
        for place in top.tables(word)? {
            let section = Section::any(source, word, place);
            for key in ["face", "patch", "nodes"] {
                if !section.is_text(key) {
                    continue;
                }
                let name = section.text(key)?;
                let Some(label) = labelled(&name, mesh) else { continue };
                let all =
                    || mesh.node_labels.iter().enumerate().map(|(index, label)| (*label, index)).collect();
                let node = index.get_or_insert_with(all).get(&label);
                if let Some(node) = node {
                    mesh.node_sets.entry(name).or_insert_with(|| vec![*node]);
                }
            }
        }
    }
    Ok(())
}

/// Indices of the nodes or elements whose numbers in the file the key `numbers` lists.
fn numbered(
    section: &Section<'_>,
    word: &str,
    labels: impl Iterator<Item = u64>,
) -> Result<Vec<usize>, InputError> {
    let index: BTreeMap<u64, usize> = labels.enumerate().map(|(index, label)| (label, index)).collect();
    let mut members = Vec::new();
    for number in section.numbers("numbers")? {
        let label = Some(number).filter(|n| n.fract() == 0.0 && *n >= 0.0).map(|n| n as u64);
        let Some(member) = label.and_then(|label| index.get(&label)) else {
            let message = format!("there is no {word} {number} in the mesh");
            let remedy = format!("give numbers of {word}s of the mesh file");
            return Err(section.failure("numbers", &message, &remedy));
        };
        members.push(*member);
    }
    members.sort_unstable();
    members.dedup();
    Ok(members)
}

/// The nodes inside a box, its faces included.
fn inside(section: &Section<'_>, mesh: &Mesh) -> Result<Vec<usize>, InputError> {
    let (low, high) = (triple(section, "low")?, triple(section, "high")?);
    let spread = |axis: usize| {
        let along = mesh.positions.iter().map(|p| p[axis]);
        along.clone().fold(f64::NEG_INFINITY, f64::max) - along.fold(f64::INFINITY, f64::min)
    };
    let margin = ROUNDING * (0..3).map(|axis| spread(axis).powi(2)).sum::<f64>().sqrt();
    let within = |p: &[f64; 3]| (0..3).all(|a| p[a] >= low[a] - margin && p[a] <= high[a] + margin);
    let members: Vec<usize> = (0..mesh.positions.len()).filter(|n| within(&mesh.positions[*n])).collect();
    if members.is_empty() {
        let message = format!("there is no node between low = {low:?} and high = {high:?}");
        return Err(section.failure("low", &message, "widen the box; its faces belong to it"));
    }
    Ok(members)
}

/// The three finite numbers of a key.
pub(super) fn triple(section: &Section<'_>, key: &str) -> Result<[f64; 3], InputError> {
    let numbers = section.numbers(key)?;
    match numbers[..] {
        [x, y, z] if numbers.iter().all(|n| n.is_finite()) => Ok([x, y, z]),
        _ => {
            let message = format!("{key} = {numbers:?} is not three finite numbers");
            Err(section.failure(key, &message, &format!("give {key} as [X, Y, Z]")))
        }
    }
}

/// The direction of a key, of length 1, given as `"x"`, `"-z"`, or three numbers.
pub(super) fn direction(section: &Section<'_>, key: &str) -> Result<[f64; 3], InputError> {
    const NAMED: &[(&str, [f64; 3])] = &[
        ("x", [1.0, 0.0, 0.0]),
        ("y", [0.0, 1.0, 0.0]),
        ("z", [0.0, 0.0, 1.0]),
        ("-x", [-1.0, 0.0, 0.0]),
        ("-y", [0.0, -1.0, 0.0]),
        ("-z", [0.0, 0.0, -1.0]),
    ];
    if section.is_text(key) {
        return section.choice(key, NAMED).map(Option::unwrap_or_default);
    }
    let vector = triple(section, key)?;
    let length = vector.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length > 0.0 && length.is_finite() {
        return Ok(vector.map(|x| x / length));
    }
    let message = format!("{key} = {vector:?} has no length");
    Err(section.failure(key, &message, "give \"x\", \"y\", \"z\" or three numbers that are not all zero"))
}

/// The name of a set in `sets`; an error where there is no such set.
pub(super) fn known(
    section: &Section<'_>,
    key: &str,
    word: &str,
    sets: &BTreeMap<String, Vec<usize>>,
) -> Result<String, InputError> {
    let name = section.text(key)?;
    if sets.contains_key(&name) {
        return Ok(name);
    }
    let names: Vec<&str> = sets.keys().map(String::as_str).collect();
    let message = format!("{key} = \"{name}\": there is no {word} set of that name");
    let remedy = match nearest(&name, &names) {
        Some(near) => format!("did you mean \"{near}\"? The mesh has {}", listed(&names)),
        None if names.is_empty() => format!("the mesh has no {word} sets: add one with [[set]]"),
        None => format!("choose one of {}, or add one with [[set]]", listed(&names)),
    };
    Err(section.failure(key, &message, &remedy))
}
