//! `[structure]`: a scenario on a finite-element structure instead of modes.

use std::path::PathBuf;

use crate::error::InputError;
use crate::section::{Section, plain};
use crate::structure::{BUILT_IN_STRUCTURES, StructureFile, built_in_structure};
use crate::text::InputText;
use iwan_core::Representation;
use iwan_fem::Model;
use iwan_sim::Method;

/// Keys of the table.
pub(crate) const KEYS: &[&str] =
    &["path", "name", "reduced", "model", "basis", "tolerance", "modes", "frames"];

/// Where the structure comes from.
#[derive(Debug, Clone, PartialEq)]
pub enum Origin {
    /// A file.
    File(PathBuf),
    /// A built-in structure, by its name.
    BuiltIn(&'static str),
    /// The folder of a reduced model.
    Reduced(PathBuf),
}

/// The table as written, with defaults filled in.
#[derive(Debug, Clone, PartialEq)]
pub struct OnStructure {
    /// Where the structure comes from.
    pub origin: Origin,
    /// Which model is integrated.
    pub model: Model,
    /// Names of the modes whose modal coordinates are recorded; empty: the first three bending modes.
    pub modes: Vec<String>,
    /// Number of pictures of the moving structure that are written for ParaView.
    pub frames: usize,
}

impl OnStructure {
    /// Reads the table, if there is one.
    pub(super) fn read(source: &InputText, top: &Section<'_>) -> Result<Option<Self>, InputError> {
        let Some(place) = top.optional_table("structure")? else { return Ok(None) };
        let section = Section::new(source, "[structure]", place, KEYS)?;
        if top.has("mode") {
            let message = "[structure] and [[mode]] exclude each other";
            return Err(top.failure("mode", message, "keep the modes, or the structure they belong to"));
        }
        if top.has("joint") {
            let message = "[structure] and [[joint]] exclude each other";
            return Err(top.failure("joint", message, "give the joints of a structure in its own file"));
        }
        let origin = origin(source, &section)?;
        let model = model(&section, matches!(origin, Origin::Reduced(_)))?;
        let frames = section.optional_count("frames")?.unwrap_or(0);
        if frames > 0 && model == Model::Full {
            let message = "frames are made from the reduced model";
            return Err(section.failure(
                "frames",
                message,
                "choose model = \"reduced\", or leave frames out",
            ));
        }
        let modes = if section.has("modes") { section.texts("modes")? } else { Vec::new() };
        Ok(Some(Self { origin, model, modes, frames }))
    }

    /// Loads the structure; returns its name for messages, and the structure file.
    ///
    /// # Errors
    /// [`InputError`] for a file that cannot be read or is no structure.
    pub fn load(&self) -> Result<(String, StructureFile), InputError> {
        let source = match &self.origin {
            Origin::File(path) => InputText::read(path, "structure", BUILT_IN_STRUCTURES[0].0)?,
            Origin::BuiltIn(name) => built_in_structure(name)?,
            Origin::Reduced(folder) => {
                return StructureFile::open_reduced(folder).map(|(source, file)| (source.name, file));
            }
        };
        Ok((source.name.clone(), StructureFile::read(&source)?))
    }
}

fn origin(source: &InputText, section: &Section<'_>) -> Result<Origin, InputError> {
    let names: Vec<(&str, &'static str)> = BUILT_IN_STRUCTURES.iter().map(|b| (b.0, b.0)).collect();
    let given =
        (section.optional_text("path")?, section.choice("name", &names)?, section.optional_text("reduced")?);
    match given {
        (Some(path), None, None) => Ok(Origin::File(source.folder.join(path))),
        (None, Some(name), None) => Ok(Origin::BuiltIn(name)),
        (None, None, Some(folder)) => Ok(Origin::Reduced(source.folder.join(folder))),
        (path, name, reduced) => {
            let message = match (path, name, reduced) {
                (None, None, None) => "the key `path` is missing",
                (Some(_), Some(_), None) => "`path` and `name` exclude each other",
                _ => "`reduced` excludes `path` and `name`: the folder says which structure it belongs to",
            };
            let remedy = "give path = \"FILE.toml\", reduced = \"FOLDER\" for a reduced model that was written, or \
                          name = \"paper-a\" for a built-in structure";
            Err(section.failure("path", message, remedy))
        }
    }
}

fn model(section: &Section<'_>, kept: bool) -> Result<Model, InputError> {
    let full = section.choice("model", &[("reduced", false), ("full", true)])?.unwrap_or(false);
    let basis = section.optional_count("basis")?;
    let tolerance = section.optional_number("tolerance")?;
    for (key, given) in [("basis", basis.is_some()), ("tolerance", tolerance.is_some())] {
        if full && given {
            let message = format!("`{key}` does not apply to model = \"full\"");
            return Err(section.failure(key, &message, "remove it, or choose model = \"reduced\""));
        }
        if kept && given {
            let message = format!(
                "`{key}` does not apply to a reduced model that was written: its basis is in the folder"
            );
            return Err(section.failure(key, &message, "remove it, or give path = \"FILE.toml\""));
        }
    }
    match (full, basis, tolerance) {
        (true, ..) => Ok(Model::Full),
        _ if kept => Ok(Model::Kept),
        (_, Some(_), Some(_)) => {
            let message = "`basis` and `tolerance` exclude each other";
            Err(section.failure("basis", message, "fix the number of modes, or the error they may cause"))
        }
        (_, Some(modes), None) => Ok(Model::Basis(modes)),
        (_, None, None) => Ok(Model::USUAL),
        (_, None, Some(tolerance)) => {
            if tolerance > 0.0 && tolerance.is_finite() {
                return Ok(Model::Tolerance(tolerance));
            }
            let message =
                format!("tolerance = {} is out of range: must be a finite number > 0", plain(tolerance));
            Err(section.failure("tolerance", &message, "give a relative error such as 0.05"))
        }
    }
}

/// How the joints of a structure are evaluated when a scenario's method is applied to it: with average acceleration and no prewarping.
#[must_use]
pub const fn representation(method: &Method) -> Representation {
    match *method {
        Method::Newmark { joint, .. } => joint,
        _ => Representation::Continuum,
    }
}
