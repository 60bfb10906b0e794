//! `[[support]]`, `[[lump]]`, `[[load]]` and `[[output]]`: supports, lumped masses and springs, points of forces, and points of responses.

use std::collections::BTreeSet;

use iwan_fem::mesh::Mesh;
use iwan_fem::{Assembled, Lump, Structure, Support};

use super::given::Combinations;
use super::sets::{direction, known, triple};
use crate::error::InputError;
use crate::section::{Section, plain};
use crate::text::InputText;

/// Keys of a support.
pub(super) const SUPPORT_KEYS: &[&str] = &["name", "nodes", "fixed"];
/// Keys of a lumped mass or spring.
pub(super) const LUMP_KEYS: &[&str] = &["name", "nodes", "mass", "stiffness"];
/// Keys of a load.
pub(super) const LOAD_KEYS: &[&str] =
    &["name", "nodes", "direction", "relative", "relative_name", "format", "row", "factor"];
/// Keys of an output.
pub(super) const OUTPUT_KEYS: &[&str] =
    &["name", "nodes", "direction", "relative", "relative_name", "format", "row"];

/// Where a load acts and an output is read.
#[derive(Debug, Clone, PartialEq)]
pub enum Point {
    /// A node set along a direction: a force is divided equally among all nodes, and a displacement is the mean over all nodes.
    Nodes {
        /// The set.
        set: String,
        /// Direction, of length 1.
        direction: [f64; 3],
    },
    /// A combination of the rows of given matrices: rows (from 0) with coefficients.
    Rows(Vec<(usize, f64)>),
}

impl Point {
    /// Forces on the unknowns, one for each, of a force at this point. For a force of 1 they are also the coefficients by which the
    /// unknowns give the displacement of the point.
    ///
    /// # Errors
    /// [`iwan_fem::Error`] where the point does not fit the structure.
    pub fn forces(&self, assembled: &Assembled, force: f64) -> Result<Vec<f64>, iwan_fem::Error> {
        match self {
            Self::Nodes { set, direction } => assembled.load(set, direction.map(|d| d * force)),
            Self::Rows(terms) => {
                let scaled: Vec<(usize, f64)> = terms.iter().map(|&(row, c)| (row, c * force)).collect();
                assembled.combination(&scaled)
            }
        }
    }

    /// Reads the point from the keys `nodes` and `direction`, or `relative` and `row`.
    fn read(source: &InputText, section: &Section<'_>, structure: &Structure) -> Result<Self, InputError> {
        if !section.has("relative") {
            if let Some(key) = ["relative_name", "format", "row"].into_iter().find(|key| section.has(key)) {
                let message = format!("{key} without relative: it belongs to a row of a matrix");
                return Err(section.failure(
                    key,
                    &message,
                    "remove it, or name the matrix with relative = \"FILE\"",
                ));
            }
            let set = known(section, "nodes", "node", &structure.mesh.node_sets)?;
            return Ok(Self::Nodes { set, direction: direction(section, "direction")? });
        }
        if let Some(key) = ["nodes", "direction"].into_iter().find(|key| section.has(key)) {
            let message = format!("{key} beside relative: the row of the matrix says what is meant");
            return Err(section.failure(key, &message, "remove one of the two"));
        }
        let rows = structure.given.as_ref().map(|given| given.rows.len());
        let combinations = Combinations::read(section, &source.folder, "relative", rows)?;
        Ok(Self::Rows(combinations.one(section, "row")?))
    }
}

/// Where the force of a scenario acts.
#[derive(Debug, Clone, PartialEq)]
pub struct Load {
    /// Name for messages and reports.
    pub name: String,
    /// The point where the load acts.
    pub at: Point,
    /// Ratio of the total force of this load to the force of the scenario.
    pub factor: f64,
}

/// A point whose motion is wanted.
#[derive(Debug, Clone, PartialEq)]
pub struct Output {
    /// Name, with which the columns of the response begin.
    pub name: String,
    /// The point whose motion is wanted.
    pub at: Point,
}

/// The table with its name as title; the name must be given, and must not be `taken`.
pub(super) fn name<'a>(
    section: Section<'a>,
    word: &str,
    taken: impl Fn(&str) -> bool,
) -> Result<(Section<'a>, String), InputError> {
    let name = section.name("name")?;
    if taken(&name) {
        let message = format!("name = \"{name}\" is taken already");
        return Err(section.failure("name", &message, "give each a name of its own"));
    }
    Ok((section.renamed(format!("{word} \"{name}\"")), name))
}

/// Reads all tables of one kind.
fn each<T>(
    source: &InputText,
    top: &Section<'_>,
    (word, keys): (&str, &[&str]),
    mut read: impl FnMut(&Section<'_>, String) -> Result<T, InputError>,
) -> Result<Vec<T>, InputError> {
    let (mut all, mut names) = (Vec::new(), BTreeSet::new());
    for (index, place) in top.tables(word)?.into_iter().enumerate() {
        let section = Section::new(source, format!("{word} {}", index + 1), place, keys)?;
        let (section, name) = name(section, word, |given| names.contains(given))?;
        names.insert(name.clone());
        all.push(read(&section, name)?);
    }
    Ok(all)
}

pub(super) fn supports(
    source: &InputText,
    top: &Section<'_>,
    mesh: &Mesh,
) -> Result<Vec<Support>, InputError> {
    each(source, top, ("support", SUPPORT_KEYS), |section, name| {
        let mut fixed = [false; 3];
        for axis in section.texts("fixed")? {
            let Some(axis) = ["x", "y", "z"].iter().position(|known| *known == axis) else {
                let message = format!("fixed: \"{axis}\" is not known");
                return Err(section.failure("fixed", &message, "choose from \"x\", \"y\", \"z\""));
            };
            fixed[axis] = true;
        }
        if fixed == [false; 3] {
            return Err(section.failure(
                "fixed",
                "it fixes no direction",
                "name at least one of \"x\", \"y\", \"z\"",
            ));
        }
        Ok(Support { name, nodes: known(section, "nodes", "node", &mesh.node_sets)?, fixed })
    })
}

pub(super) fn lumps(source: &InputText, top: &Section<'_>, mesh: &Mesh) -> Result<Vec<Lump>, InputError> {
    each(source, top, ("lump", LUMP_KEYS), |section, name| {
        let mass = section.number_or("mass", 0.0)?;
        let stiffness = if section.has("stiffness") { triple(section, "stiffness")? } else { [0.0; 3] };
        for (key, value) in [("mass", mass)].into_iter().chain(stiffness.map(|k| ("stiffness", k))) {
            if !(value.is_finite() && value >= 0.0) {
                let message =
                    format!("{key} = {} is out of range: must be a finite number >= 0", plain(value));
                return Err(section.failure(key, &message, &format!("give {key} a value >= 0")));
            }
        }
        Ok(Lump { name, nodes: known(section, "nodes", "node", &mesh.node_sets)?, mass, stiffness })
    })
}

pub(super) fn loads(
    source: &InputText,
    top: &Section<'_>,
    structure: &Structure,
) -> Result<Vec<Load>, InputError> {
    each(source, top, ("load", LOAD_KEYS), |section, name| {
        let factor = section.number_or("factor", 1.0)?;
        if !factor.is_finite() {
            let message = format!("factor = {factor} is out of range: must be a finite number");
            return Err(section.failure(
                "factor",
                &message,
                "leave it out for the force of the scenario itself",
            ));
        }
        Ok(Load { name, at: Point::read(source, section, structure)?, factor })
    })
}

pub(super) fn outputs(
    source: &InputText,
    top: &Section<'_>,
    structure: &Structure,
) -> Result<Vec<Output>, InputError> {
    each(source, top, ("output", OUTPUT_KEYS), |section, name| {
        Ok(Output { name, at: Point::read(source, section, structure)? })
    })
}
