//! `[[joint]]` and `[[tie]]` of a structure file.

use std::collections::BTreeSet;
use std::fmt;
use std::sync::Arc;

use iwan_core::Backbone;
use iwan_fem::mesh::Mesh;
use iwan_fem::{Interface, Joint, Law, Patch, Structure};

use super::ends::name;
use super::sets::{direction, known};
use crate::error::InputError;
use crate::section::{Section, TablePlace};
use crate::text::InputText;
use crate::written_law::WrittenLaw;

/// Keys of a joint.
pub(super) const JOINT_KEYS: &[&str] =
    &["name", "face", "patch", "motion", "slip", "relative", "relative_name", "format", "to_ground"];
/// Keys of a tie.
pub(super) const TIE_KEYS: &[&str] = &["name", "face", "patch", "motion"];
/// Keys of a slip.
pub(super) const SLIP_KEYS: &[&str] = &["direction", "law", "rows"];

/// Ways in which the nodes of a face follow their patch, by their names in the file.
const MOTIONS: &[(&str, Interface)] = &[
    ("rigid", Interface::Whole(Patch::Rigid)),
    ("averaging", Interface::Whole(Patch::Averaging)),
    ("node-to-node", Interface::NodeToNode),
    ("directions", Interface::Directions),
];

/// Reads joints, then ties.
pub(super) fn read(
    source: &InputText,
    top: &Section<'_>,
    mesh: &Mesh,
) -> Result<(Vec<Joint>, Vec<StructureLaw>), InputError> {
    let (mut joints, mut names, mut laws) = (Vec::new(), BTreeSet::new(), Vec::new());
    for (word, keys) in [("joint", JOINT_KEYS), ("tie", TIE_KEYS)] {
        for (index, place) in top.tables(word)?.into_iter().enumerate() {
            let section = Section::new(source, format!("{word} {}", index + 1), place, keys)?;
            if word == "joint" && section.has("relative") {
                continue;
            }
            if let Some(key) =
                ["relative_name", "format", "to_ground"].into_iter().find(|key| section.has(key))
            {
                let message = format!("{key} without relative: it belongs to a joint by rows of a matrix");
                return Err(section.failure(
                    key,
                    &message,
                    "remove it, or name the matrix with relative = \"FILE\"",
                ));
            }
            let (section, name) = name(section, word, |given| names.contains(given))?;
            names.insert(name.clone());
            let face = known(&section, "face", "node", &mesh.node_sets)?;
            let patch = known(&section, "patch", "node", &mesh.node_sets)?;
            // A tie without directions of its own would tie nothing, so "directions", the last of `MOTIONS`, is for joints only.
            if word == "tie" && is_projected(&section)? {
                continue;
            }
            let motions = if word == "joint" { MOTIONS } else { &MOTIONS[..3] };
            let motion = section.choice("motion", motions)?.unwrap_or(Interface::Whole(Patch::default()));
            let mut joint = Joint::new(name, face, patch, motion);
            if word == "joint" {
                joint = slips(source, &section, joint, &mut laws)?;
            }
            joints.push(joint);
        }
    }
    Ok((joints, laws))
}

/// Whether a tie has motion = "projection".
fn is_projected(section: &Section<'_>) -> Result<bool, InputError> {
    Ok(section.is_text("motion") && section.text("motion")? == PROJECTION)
}

/// Name of the motion of a tie between meshes that do not match.
const PROJECTION: &str = "projection";

/// Applies ties between meshes that do not match: nodes of the face are moved onto the faces of the patch, and follow these. Returns
/// remarks.
pub(super) fn project(
    source: &InputText,
    top: &Section<'_>,
    structure: &mut Structure,
) -> Result<Vec<String>, InputError> {
    let mut notes = Vec::new();
    for (index, place) in top.tables("tie")?.into_iter().enumerate() {
        let section = Section::new(source, format!("tie {}", index + 1), place, TIE_KEYS)?;
        if !is_projected(&section)? {
            continue;
        }
        let (section, name) = name(section, "tie", |_| false)?;
        let (face, patch) = (section.text("face")?, section.text("patch")?);
        let tied = structure.project(&name, &face, &patch, None).map_err(|error| {
            section.failure(
                "patch",
                &error.to_string(),
                "a tie by projection needs faces that are near its nodes",
            )
        })?;
        let (moved, free) = tied;
        if moved > 0.0 {
            notes.push(format!(
                "tie `{name}`: nodes of `{face}` were moved by up to {moved:.3e} onto the faces of `{patch}`"
            ));
        }
        if free > 0 {
            notes.push(format!(
                "tie `{name}`: {free} nodes of `{face}` are not near the faces of `{patch}` and stay free"
            ));
        }
    }
    Ok(notes)
}

/// A law of a slip, and the law as the file writes it.
#[derive(Clone)]
pub struct StructureLaw {
    /// The law that the structure computes with.
    pub law: Law,
    /// The law as the file writes it.
    pub written: WrittenLaw,
}

impl fmt::Debug for StructureLaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.written.fmt(f)
    }
}

fn slips(
    source: &InputText,
    section: &Section<'_>,
    mut joint: Joint,
    laws: &mut Vec<StructureLaw>,
) -> Result<Joint, InputError> {
    let places = section.tables("slip")?;
    if places.is_empty() || places.len() > 3 {
        let message = format!("it slips in {} directions", places.len());
        let remedy = "give one to three slip = [{ direction = \"x\", law = { ... } }, ...]; without any it is a [[tie]]";
        return Err(section.failure("slip", &message, remedy));
    }
    for (index, place) in places.into_iter().enumerate() {
        let title = format!("slip {} of {}", index + 1, section.title());
        let (direction, law) = slip(source, title, place)?;
        laws.extend(law.clone());
        let law = law.map(|law| law.law);
        let along = |other: [f64; 3]| other.iter().zip(direction).map(|(a, b)| a * b).sum::<f64>();
        if let Some(other) = joint.slips.iter().position(|slip| along(slip.direction).abs() > ORTHOGONAL) {
            let message = format!("its directions {} and {} are not orthogonal", other + 1, index + 1);
            return Err(section.failure("slip", &message, "give directions at right angles"));
        }
        joint = joint.slip(direction, law);
    }
    Ok(joint)
}

/// Largest cosine between two directions that count as orthogonal: rounding of seven digits. The assembly, which does not know the file,
/// allows 1e-9, and refuses directions between the two limits.
const ORTHOGONAL: f64 = 1e-6;

fn slip<'a>(
    source: &'a InputText,
    title: String,
    place: TablePlace<'a>,
) -> Result<([f64; 3], Option<StructureLaw>), InputError> {
    let section = Section::new(source, title, place, SLIP_KEYS)?;
    if section.has("rows") {
        let message = "rows in a joint between node sets";
        return Err(section.failure(
            "rows",
            message,
            "give direction = \"x\" in its place, or the joint a matrix by relative = \"FILE\"",
        ));
    }
    Ok((direction(&section, "direction")?, law(source, &section)?))
}

/// The law of a slip; none for a slip without a law, which slides freely.
pub(super) fn law(source: &InputText, slip: &Section<'_>) -> Result<Option<StructureLaw>, InputError> {
    let Some(place) = slip.optional_table("law")? else { return Ok(None) };
    let (written, law) = WrittenLaw::read(source, format!("law of {}", slip.title()), place)?;
    if law.friction_ratio() != 1.0 {
        let message = "theta is below 1: the joints of a structure follow Masing's rule, and dynamic below static friction does not";
        return Err(slip.failure("law", message, "take the four-parameter law without theta"));
    }
    Ok(Some(StructureLaw { law: Arc::new(law), written }))
}
