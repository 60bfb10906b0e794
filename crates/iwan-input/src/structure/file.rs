//! A structure file as a whole.

use std::path::Path;

use iwan_fem::Structure;
use iwan_fem::mesh::MeshFile;
use iwan_machine::Kind;

use super::between_rows;
use super::ends::{self, Load, Output};
use super::joints::{self, StructureLaw};
use super::{given, materials, meshes, sets};
use crate::error::InputError;
use crate::section::Section;
use crate::text::InputText;

/// JSON Schema (draft 2020-12) of structure files.
pub const STRUCTURE_SCHEMA: &str = include_str!("../../schema/structure.schema.json");

/// Keys at the top of a structure file.
pub(super) const KEYS: &[&str] = &[
    "title", "mesh", "matrices", "set", "elements", "material", "joint", "tie", "support", "lump", "load",
    "output",
];

/// Whether a file describes a structure rather than a scenario: whether it has a mesh or matrices.
///
/// # Errors
/// [`InputError`] where the file is no valid TOML.
///
/// ```
/// use iwan_input::{built_in_structure, is_structure, scenario::built_in};
/// assert!(is_structure(&built_in_structure("paper-a")?)? && !is_structure(&built_in()[0].source())?);
/// # Ok::<(), iwan_input::InputError>(())
/// ```
pub fn is_structure(source: &InputText) -> Result<bool, InputError> {
    let document = source.document("paper-a")?;
    let top = document.top();
    Ok(top.has("mesh") || top.has("matrices"))
}

/// A structure file, read and checked.
#[derive(Debug, Clone)]
pub struct StructureFile {
    /// Title for reports.
    pub title: Option<String>,
    /// Mesh, materials, and the joints, ties and supports.
    pub structure: Structure,
    /// Laws of the structure's slips as the file writes them.
    pub laws: Vec<StructureLaw>,
    /// Where the force of a scenario acts.
    pub loads: Vec<Load>,
    /// Points whose motion is wanted.
    pub outputs: Vec<Output>,
    /// What the user should know: remarks of the mesh reader and of the check.
    pub notes: Vec<String>,
}

impl StructureFile {
    /// Reads a structure file; paths in it are relative to its folder.
    ///
    /// # Errors
    /// [`InputError`] for a file that cannot be read, for values out of range (with file, line and key), for faulty mesh files, and for
    /// every defect that [`Structure::check`] finds.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, InputError> {
        Self::read(&InputText::read(path.as_ref(), "structure", "paper-a")?)
    }

    /// Reads a structure file from a text.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    ///
    /// ```
    /// use iwan_input::{BUILT_IN_STRUCTURES, InputText, StructureFile};
    /// let (name, _, text) = BUILT_IN_STRUCTURES[0];
    /// let file = StructureFile::read(&InputText::built_in(name, text))?;
    /// assert_eq!(file.structure.mesh.positions.len(), 1554);
    /// # Ok::<(), iwan_input::InputError>(())
    /// ```
    pub fn read(source: &InputText) -> Result<Self, InputError> {
        let document = source.document("paper-a")?;
        let top = Section::new(source, "the structure", document.top(), KEYS)?;
        let (mut structure, mut notes) = body(source, &top)?;
        let (read, mut laws) = joints::read(source, &top, &structure.mesh)?;
        structure.joints = read;
        between_rows::read(source, &top, &mut structure, &mut laws)?;
        notes.extend(joints::project(source, &top, &mut structure)?);
        structure.supports = ends::supports(source, &top, &structure.mesh)?;
        structure.lumps = ends::lumps(source, &top, &structure.mesh)?;
        let loads = ends::loads(source, &top, &structure)?;
        let outputs = ends::outputs(source, &top, &structure)?;
        let findings = structure.check();
        if let Some(message) = findings.message() {
            let message = format!("{}: the structure cannot be computed with:\n{message}", source.name);
            let remedy = "mend the mesh, or the joints in this file, as said above";
            return Err(InputError::new(message, remedy).of(Kind::Structure));
        }
        notes.extend(findings.remarks.iter().map(ToString::to_string));
        Ok(Self { title: top.optional_text("title")?, structure, laws, loads, outputs, notes })
    }
}

/// Structure of mesh, sets and materials, or of matrices with their nodes and sets; also the remarks.
fn body(source: &InputText, top: &Section<'_>) -> Result<(Structure, Vec<String>), InputError> {
    if let Some(place) = top.optional_table("matrices")? {
        let (mut structure, notes) = given::read(source, top, place)?;
        sets::read(source, top, &mut structure.mesh)?;
        return Ok((structure, notes));
    }
    let (MeshFile { mut mesh, constraints, masses, sections, .. }, notes) = meshes::read(source, top)?;
    sets::read(source, top, &mut mesh)?;
    let mut structure = materials::read(source, top, mesh, &sections)?;
    structure.constraints = constraints;
    structure.masses = masses;
    Ok((structure, notes))
}
