//! `[matrices]`: stiffness and mass from other programs.

use std::path::{Path, PathBuf};

use iwan_exchange::{Component, Label, Matrix, read_rows};
use iwan_fem::{Given, Material, Structure, Symmetric};

use super::matrix_file::{chosen, failed};
use super::recovery;
use super::row_map::{Places, rows};
use crate::error::InputError;
use crate::section::{Section, TablePlace, plain};
use crate::text::InputText;

/// Keys of `[matrices]`.
pub(in crate::structure) const MATRICES_KEYS: &[&str] = &[
    "stiffness",
    "mass",
    "damping",
    "format",
    "stiffness_name",
    "mass_name",
    "damping_name",
    "rows",
    "numbers",
    "coordinates",
    "ignore",
    "total_mass",
    "recovery",
    "recovery_name",
    "recovery_rows",
];

/// Largest difference of two entries that should be equal by symmetry, as a part of the geometric mean of the two diagonal entries: single
/// precision leaves 1e-7, and a larger difference is no rounding; the matrix is then refused.
const SYMMETRIC: f64 = 1e-6;
/// Largest relative difference between the stated total mass and that of the matrices, since the user states it with a few digits only.
/// With more, the file is refused.
const MASS: f64 = 1e-3;

/// The structure of given matrices, and the remarks on its files.
pub(in crate::structure) fn read(
    source: &InputText,
    top: &Section<'_>,
    place: TablePlace<'_>,
) -> Result<(Structure, Vec<String>), InputError> {
    for key in ["mesh", "material", "elements"] {
        if top.has(key) {
            let message = format!("[{key}] beside [matrices]: the matrices hold what it would say");
            return Err(top.failure(
                key,
                &message,
                "remove one of the two; a mesh for pictures is coordinates in [matrices]",
            ));
        }
    }
    let section = Section::new(source, "[matrices]", place, MATRICES_KEYS)?;
    let reading = Reading { section: &section, folder: &source.folder };
    let (stiffness_file, stiffness) = reading.matrix("stiffness", STIFFNESS)?;
    let (mass_file, mass) = reading.matrix("mass", MASSES)?;
    let labels = reading.labels(&stiffness)?;
    let mass = reading.in_order_of(&labels, stiffness.labels.as_deref(), ("mass", mass))?;
    let given_labels = stiffness.labels.clone();
    let recovery = recovery::read(&section, &source.folder, &labels)?;
    let mut places = Places::read(&section, &source.folder, &labels, recovery.nodes())?;
    let rows = rows(&section, &mut places, &labels, recovery.nodes())?;
    let recovered = recovery.placed(&places.mesh);
    let stiffness = reading.symmetric("stiffness", &stiffness_file, &stiffness, &labels)?;
    let mass = reading.symmetric("mass", &mass_file, &mass, &labels)?;
    let damping = reading.damping(&labels, given_labels.as_deref())?;
    let Places { mesh, placed, notes } = places;
    let mut structure = Structure::new(mesh, unused()?);
    structure.given = Some(Given { rows, stiffness, mass, damping, placed, recovered, relative: Vec::new() });
    check_mass(&section, &structure)?;
    Ok((structure, notes))
}

/// The material of a structure whose elements have none; it is never used.
fn unused() -> Result<Material, InputError> {
    Material::new(1.0, 0.0, 1.0).map_err(|e| InputError::new(e.to_string(), "report this"))
}

/// Names of stiffness, mass and damping matrices in the files of several programs.
const STIFFNESS: &[&str] = &["K", "KR", "STIFFNESS", "KAA", "KAAX", "KGG", "K2GG", "K2PP", "KXX"];
const MASSES: &[&str] = &["M", "MR", "MASS", "MAA", "MAAX", "MGG", "M2GG", "M2PP", "MXX"];
const DAMPINGS: &[&str] = &["C", "CR", "B", "DAMPING", "BAA", "BAAX", "BGG", "B2GG", "B2PP", "BXX"];

/// Reads the files that the table `[matrices]` names.
struct Reading<'r, 's> {
    section: &'r Section<'s>,
    folder: &'r Path,
}

impl Reading<'_, '_> {
    /// The real square matrix of the file that `key` names.
    fn matrix(&self, key: &str, usual: &[&str]) -> Result<(PathBuf, Matrix), InputError> {
        let (path, matrix) = chosen(self.section, self.folder, key, usual)?;
        if matrix.rows != matrix.columns || matrix.rows == 0 {
            let message = format!(
                "{}: the {key} has {} rows and {} columns",
                path.display(),
                matrix.rows,
                matrix.columns
            );
            return Err(self.section.failure(
                key,
                &message,
                "stiffness, mass and damping are square: choose that matrix",
            ));
        }
        Ok((path, matrix))
    }

    /// The damping matrix, if there is one, with its rows in the order of the stiffness's.
    fn damping(
        &self,
        labels: &[Label],
        of_stiffness: Option<&[Label]>,
    ) -> Result<Option<Symmetric>, InputError> {
        if !self.section.has("damping") {
            return Ok(None);
        }
        let (file, damping) = self.matrix("damping", DAMPINGS)?;
        let damping = self.in_order_of(labels, of_stiffness, ("damping", damping))?;
        let damping = self.symmetric("damping", &file, &damping, labels)?;
        if let Some(row) = (0..damping.order()).find(|&row| damping.diagonal_entry(row) < 0.0) {
            let value = plain(damping.diagonal_entry(row));
            let message = format!(
                "{}: row {} ({}) of the damping has {value} on its diagonal",
                file.display(),
                row + 1,
                labels[row]
            );
            return Err(self.section.failure(
                "damping",
                &message,
                "a viscous damping gives no energy back: check signs",
            ));
        }
        Ok(Some(damping))
    }

    /// The meaning of the rows: from the key `rows`, else from the stiffness's file; else each row is the displacement along x of a node of
    /// its own.
    fn labels(&self, stiffness: &Matrix) -> Result<Vec<Label>, InputError> {
        let labels = match (self.section.optional_text("rows")?, &stiffness.labels) {
            (Some(file), _) => {
                let numbers = self.section.optional_text("numbers")?.map(|file| self.folder.join(file));
                read_rows(self.folder.join(file), numbers.as_deref())
                    .map_err(|error| failed(self.section, "rows", &error))?
            }
            (None, Some(labels)) => labels.clone(),
            (None, None) => {
                let label =
                    |row: usize| Label { node: row as u64 + 1, component: Component::Displacement(0) };
                (0..stiffness.rows).map(label).collect()
            }
        };
        if labels.len() != stiffness.rows {
            let message =
                format!("{} rows are named, but the stiffness has {}", labels.len(), stiffness.rows);
            return Err(self.section.failure("rows", &message, "give the row map of this matrix"));
        }
        Ok(labels)
    }

    /// The mass or damping matrix with its rows in the order of the stiffness's. Rows that only the stiffness has get zeros.
    fn in_order_of(
        &self,
        labels: &[Label],
        of_stiffness: Option<&[Label]>,
        (key, mut mass): (&str, Matrix),
    ) -> Result<Matrix, InputError> {
        if let (Some(_), Some(own)) = (of_stiffness, mass.labels.take())
            && !self.section.has("rows")
        {
            let index: std::collections::BTreeMap<Label, u32> =
                labels.iter().enumerate().map(|(row, label)| (*label, row as u32)).collect();
            let mut map = Vec::with_capacity(own.len());
            for label in &own {
                map.push(*index.get(label).ok_or_else(|| {
                    let message = format!("the {key} has {label}, which the stiffness has not");
                    self.section.failure(key, &message, "take both matrices from one model")
                })?);
            }
            for entry in &mut mass.entries {
                (entry.0, entry.1) = (map[entry.0 as usize], map[entry.1 as usize]);
            }
            (mass.rows, mass.columns) = (labels.len(), labels.len());
        }
        // A file of triplets ends with the last entry that is not zero, so that last rows of zeros may be missing.
        if mass.rows < labels.len() {
            (mass.rows, mass.columns) = (labels.len(), labels.len());
        }
        if mass.rows != labels.len() {
            let message = format!("the {key} has {} rows, the stiffness {}", mass.rows, labels.len());
            return Err(self.section.failure(key, &message, "take both matrices from one model"));
        }
        Ok(mass)
    }

    fn symmetric(
        &self,
        key: &str,
        file: &Path,
        matrix: &Matrix,
        labels: &[Label],
    ) -> Result<Symmetric, InputError> {
        let lower = matrix.lower_triangle(SYMMETRIC).map_err(|found| {
            let (row, column) = (found.row, found.column);
            let message = format!(
                "{}: the {key} is not symmetric: row {} ({}), column {} ({}) is {}, and mirrored {}",
                file.display(),
                row + 1,
                labels[row],
                column + 1,
                labels[column],
                plain(found.value),
                plain(found.mirrored)
            );
            let remedy =
                "export the symmetric matrix; damping, gyroscopic and follower terms are no stiffness";
            self.section.failure(key, &message, remedy)
        })?;
        Ok(Symmetric::from_lower(labels.len(), lower))
    }
}

/// Compares the total mass of the matrices with the mass that the file states.
fn check_mass(section: &Section<'_>, structure: &Structure) -> Result<(), InputError> {
    let Some(stated) = section.optional_number("total_mass")? else { return Ok(()) };
    let failed = |e: iwan_fem::Error| section.failure("stiffness", &e.to_string(), "correct the matrices");
    let found = structure.assemble().map_err(failed)?.total_mass();
    if stated > 0.0 && (found / stated - 1.0).abs() <= MASS {
        return Ok(());
    }
    let message = format!("total_mass = {}, but the mass moves {} along x", plain(stated), plain(found));
    Err(section.failure("total_mass", &message, "check units and rows, or correct total_mass"))
}
