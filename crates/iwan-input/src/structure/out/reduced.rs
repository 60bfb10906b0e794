//! A reduced model as a folder: the structure file, the folder to which its paths are relative, and the modes for which matrices were
//! factored.

use std::io::{self, Seek, Write};
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

use iwan_exchange::{ArrayRef, StoredArray, arrays_to_npz, read_arrays};
use iwan_fem::{Kept, KeptModes};

use super::super::file::StructureFile;
use crate::error::InputError;
use crate::section::Section;
use crate::text::{InputText, quoted};

/// Names of the files in the folder: the table, the unchanged structure file, and the arrays.
const TABLE: &str = "reduced.toml";
const TEXT: &str = "reduced-structure.toml";
const ARRAYS: &str = "reduced.npz";
/// Keys of the table.
const KEYS: &[&str] = &["format", "name", "folder", "fingerprint", "named", "zero_modes"];
/// Version of the format that is written; folders of other versions are refused.
const FORMAT: usize = 1;
/// Sets of modes in the archive; the eigenvalues of each are in `NAME_values`, its vectors in `NAME_vectors`.
const NAMES: [&str; 4] = ["stuck", "slipping", "basis", "attachments"];
const WRITE_AGAIN: &str =
    "write the folder again with `iwan modes STRUCTURE.toml --write-reduced N --out FOLDER`";

/// A reduced model to be written.
#[derive(Debug, Clone, Copy)]
pub struct ReducedFolder<'a> {
    /// The structure file to which the model belongs.
    pub source: &'a InputText,
    /// Modes and basis.
    pub kept: &'a Kept,
}

impl ReducedFolder<'_> {
    /// Names of the folder's files; a folder that holds the first of them is one of a reduced model.
    pub const FILES: [&'static str; 3] = [TABLE, TEXT, ARRAYS];

    /// Whether a path is the folder of a reduced model.
    ///
    /// ```
    /// assert!(!iwan_input::ReducedFolder::is_one("structure.toml".as_ref()));
    /// ```
    #[must_use]
    pub fn is_one(path: &Path) -> bool {
        path.is_dir() && path.join(TABLE).is_file()
    }

    /// The text of the table; `folder` is the folder for which it is meant.
    #[must_use]
    pub fn table(&self, folder: &Path) -> String {
        let Kept { fingerprint, named, stuck, slipping, basis, attachments } = self.kept;
        let here = from_to(folder, &self.source.folder).display().to_string();
        format!(
            "# A reduced model. It is opened by [structure] reduced = \"this folder\" in a scenario, and in place of a structure file.\n\
             # {} modes and {} attachment vectors; the structure is {TEXT}, whose paths begin at `folder`.\n\
             format = {FORMAT}\n\
             name = {}\n\
             folder = {}\n\
             fingerprint = \"{fingerprint:016x}\"   # of stiffness and mass: laws may change as long as their K_T stays\n\
             named = {named}\n\
             zero_modes = [{}, {}, {}]   # stuck, slipping, basis\n",
            basis.values.len(),
            attachments.values.len(),
            quoted(&self.source.name),
            quoted(&here),
            stuck.zero,
            slipping.zero,
            basis.zero,
        )
    }

    /// The unchanged text of the structure file.
    #[must_use]
    pub fn structure(&self) -> &str {
        &self.source.text
    }

    /// Writes the arrays of the modes.
    ///
    /// # Errors
    /// Errors of the sink.
    pub fn arrays(&self, sink: impl Write + Seek) -> io::Result<()> {
        let Kept { stuck, slipping, basis, attachments, .. } = self.kept;
        let unknowns = stuck.vectors.len() / stuck.values.len().max(1);
        let parts: Vec<(String, [usize; 2], &KeptModes)> = NAMES
            .iter()
            .zip([stuck, slipping, basis, attachments])
            .map(|(name, modes)| ((*name).to_owned(), [modes.values.len(), unknowns], modes))
            .collect();
        let names: Vec<[String; 2]> =
            parts.iter().map(|(name, ..)| [format!("{name}_values"), format!("{name}_vectors")]).collect();
        let arrays: Vec<ArrayRef<'_>> = parts
            .iter()
            .zip(&names)
            .flat_map(|((_, shape, modes), [values, vectors])| {
                [
                    ArrayRef { name: values, shape: &shape[..1], values: &modes.values },
                    ArrayRef { name: vectors, shape, values: &modes.vectors },
                ]
            })
            .collect();
        arrays_to_npz(sink, &arrays)
    }
}

/// The path from one folder to another, relative where both are known and have a common beginning.
fn from_to(from: &Path, to: &Path) -> PathBuf {
    let absolute = |path: &Path| {
        let path =
            std::path::absolute(if path.as_os_str().is_empty() { Path::new(".") } else { path }).ok()?;
        // A folder that does not exist yet lies in one that does; symbolic links of that one are followed.
        let there = path.ancestors().find(|above| above.exists())?;
        let rest = path.strip_prefix(there).ok()?;
        Some(there.canonicalize().ok()?.join(rest))
    };
    let (Some(from), Some(to)) = (absolute(from), absolute(to)) else { return to.to_path_buf() };
    let (mut a, mut b) = (from.components().peekable(), to.components().peekable());
    if a.peek() != b.peek() {
        return to;
    }
    while a.peek().is_some() && a.peek() == b.peek() {
        a.next();
        b.next();
    }
    let up = a.map(|_| Component::ParentDir);
    let way: PathBuf = up.chain(b).collect();
    if way.as_os_str().is_empty() { PathBuf::from(".") } else { way }
}

impl StructureFile {
    /// Opens the folder of a reduced model that `iwan modes --write-reduced` wrote; returns also its structure file, for messages and
    /// copies.
    ///
    /// # Errors
    /// As [`read`](Self::read); [`InputError`] for a folder that is no reduced model, or is damaged.
    pub fn open_reduced(folder: &Path) -> Result<(InputText, Self), InputError> {
        if !ReducedFolder::is_one(folder) {
            let message = format!("{}: no folder of a reduced model: it has no {TABLE}", folder.display());
            return Err(InputError::new(message, WRITE_AGAIN));
        }
        let table = InputText::read(&folder.join(TABLE), "reduced model", "paper-a")?;
        let document = table.document("paper-a")?;
        let section = Section::new(&table, "the reduced model", document.top(), KEYS)?;
        if section.optional_count("format")? != Some(FORMAT) {
            let message = format!("format must be {FORMAT}");
            return Err(section.failure("format", &message, WRITE_AGAIN));
        }
        let mut text = InputText::read(&folder.join(TEXT), "structure", "paper-a")?;
        text.folder = folder.join(section.text("folder")?);
        text.name = format!("{} of {}", section.text("name")?, folder.display());
        let mut file = Self::read(&text)?;
        file.structure.kept = Some(Arc::new(kept(&section, folder)?));
        Ok((text, file))
    }
}

fn kept(section: &Section<'_>, folder: &Path) -> Result<Kept, InputError> {
    let written = section.text("fingerprint")?;
    let fingerprint = u64::from_str_radix(&written, 16).map_err(|_| {
        let message = format!("fingerprint = \"{written}\": must be 16 hexadecimal digits");
        section.failure("fingerprint", &message, WRITE_AGAIN)
    })?;
    let zero = section.numbers("zero_modes")?;
    let [stuck_zero, slipping_zero, basis_zero] = zero[..] else {
        return Err(section.failure("zero_modes", "zero_modes must be three numbers", WRITE_AGAIN));
    };
    let path = folder.join(ARRAYS);
    let damaged = |message: String| InputError::new(message, WRITE_AGAIN);
    let mut arrays = read_arrays(&path).map_err(|error| damaged(error.to_string()))?;
    let mut take = |name: &str, zero: f64| -> Result<KeptModes, InputError> {
        let mut array = |what: &str| -> Result<StoredArray, InputError> {
            let name = format!("{name}_{what}");
            let missing = || damaged(format!("{}: the array '{name}' is missing", path.display()));
            arrays.remove(&name).ok_or_else(missing)
        };
        let (values, vectors) = (array("values")?, array("vectors")?);
        if vectors.shape.len() != 2 || vectors.shape[0] != values.values.len() || values.shape.len() != 1 {
            let found = format!("'{name}': values {:?}, vectors {:?}", values.shape, vectors.shape);
            let expected = "one value and one row for each mode";
            return Err(damaged(format!("{}: found {found}, expected {expected}", path.display())));
        }
        if !(zero >= 0.0 && zero.fract() == 0.0 && zero <= values.values.len() as f64) {
            let message =
                format!("zero_modes has {zero} for `{name}`, which has {} modes", values.values.len());
            return Err(section.failure("zero_modes", &message, WRITE_AGAIN));
        }
        Ok(KeptModes { values: values.values, vectors: vectors.values, zero: zero as usize })
    };
    Ok(Kept {
        fingerprint,
        named: section.optional_count("named")?.unwrap_or(usize::MAX),
        stuck: take("stuck", stuck_zero)?,
        slipping: take("slipping", slipping_zero)?,
        basis: take("basis", basis_zero)?,
        attachments: take("attachments", 0.0)?,
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests may panic")]
    use super::*;

    #[test]
    fn the_way_between_folders_is_relative() {
        let root = tempfile::tempdir().unwrap();
        let (a, b) = (root.path().join("runs/one"), root.path().join("models"));
        std::fs::create_dir_all(&a).unwrap();
        std::fs::create_dir_all(&b).unwrap();
        assert_eq!(from_to(&a, &b), Path::new("../../models"));
        assert_eq!(from_to(&b, &b), Path::new("."));
        assert_eq!(from_to(&b.join("new/one"), &b), Path::new("../.."));
        assert_eq!(a.join(from_to(&a, &b)).canonicalize().unwrap(), b.canonicalize().unwrap());
    }
}
