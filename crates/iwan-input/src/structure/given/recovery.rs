//! The recovery matrix of a superelement: it gives displacements of nodes that have no rows from the displacements of the rows.

use std::collections::BTreeSet;
use std::path::Path;

use iwan_exchange::{Component, Label, read_rows};
use iwan_fem::Recovered;
use iwan_fem::mesh::Mesh;

use super::combinations::by_rows;
use super::matrix_file::{chosen, failed};
use crate::error::InputError;
use crate::section::Section;

/// Rows of the matrices (from 0) with coefficients.
type Terms = Vec<(usize, f64)>;

/// Displacements that follow from those of the rows.
#[derive(Debug, Default)]
pub(super) struct Recovery {
    /// For each displacement: number of the node, axis, and rows with coefficients.
    rows: Vec<(u64, usize, Terms)>,
    nodes: BTreeSet<u64>,
}

impl Recovery {
    /// Numbers of the nodes whose displacements are recovered.
    pub(super) fn nodes(&self) -> &BTreeSet<u64> {
        &self.nodes
    }

    /// The displacements with nodes by their index in the mesh, which has all of these nodes.
    pub(super) fn placed(self, mesh: &Mesh) -> Vec<Recovered> {
        let index: std::collections::BTreeMap<u64, usize> =
            mesh.node_labels.iter().enumerate().map(|(index, label)| (*label, index)).collect();
        let placed = |(label, axis, terms): (u64, usize, Terms)| {
            Some(Recovered { node: *index.get(&label)?, axis, terms })
        };
        self.rows.into_iter().filter_map(placed).collect()
    }
}

/// Names of recovery matrices in the files of several programs.
const USUAL: &[&str] = &["OTM", "MUG1", "GOA", "GOQ", "R"];

/// Reads what the keys `recovery` and `recovery_rows` name; nothing where these keys are missing. Left out are rows that the matrices have
/// themselves, rotations and generalised coordinates, because no output reads them.
pub(super) fn read(section: &Section<'_>, folder: &Path, labels: &[Label]) -> Result<Recovery, InputError> {
    if !section.has("recovery") {
        return Ok(Recovery::default());
    }
    let (path, matrix) = chosen(section, folder, "recovery", USUAL)?;
    let own = match (section.optional_text("recovery_rows")?, &matrix.labels) {
        (Some(file), _) => {
            read_rows(folder.join(file), None).map_err(|error| failed(section, "recovery_rows", &error))?
        }
        (None, Some(labels)) => labels.clone(),
        (None, None) => {
            let message = format!("{} does not say what its rows are", path.display());
            return Err(section.failure(
                "recovery",
                &message,
                "add recovery_rows = \"FILE\" with a line `node, component` for each row",
            ));
        }
    };
    if matrix.columns != labels.len() || own.len() != matrix.rows {
        let message = format!(
            "{}: {} rows and {} columns; {} rows are named and the stiffness has {}",
            path.display(),
            matrix.rows,
            matrix.columns,
            own.len(),
            labels.len()
        );
        return Err(section.failure(
            "recovery",
            &message,
            "give a row for each displacement that is wanted, a column for each row of the stiffness",
        ));
    }
    let (given, mut known): (BTreeSet<Label>, BTreeSet<Label>) =
        (labels.iter().copied().collect(), BTreeSet::new());
    let mut recovery = Recovery::default();
    for (row, (label, terms)) in own.iter().zip(by_rows(&matrix)).enumerate() {
        let Component::Displacement(axis) = label.component else { continue };
        if given.contains(label) {
            continue;
        }
        if !known.insert(*label) {
            let message = format!("row {} of {} is {label}, as another row is", row + 1, path.display());
            return Err(section.failure("recovery", &message, "name each displacement once"));
        }
        recovery.nodes.insert(label.node);
        recovery.rows.push((label.node, usize::from(axis), terms));
    }
    Ok(recovery)
}
