//! From the rows of a matrix file to nodes: a mesh of nodes without elements, and the meaning of each row.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use iwan_exchange::{Component, Label};
use iwan_fem::Row;
use iwan_fem::mesh::{self, Mesh};

use crate::error::InputError;
use crate::section::Section;

/// Nodes by their numbers, with their positions where the file gives these.
pub(super) struct Places {
    /// The nodes; also, for pictures, the elements of a mesh file.
    pub(super) mesh: Mesh,
    /// Whether positions are known.
    pub(super) placed: bool,
    pub(super) notes: Vec<String>,
}

impl Places {
    /// Reads the key `coordinates`: a mesh file, or a text of `node, x, y, z`. Without this key all nodes of the rows are placed at the
    /// origin.
    pub(super) fn read(
        section: &Section<'_>,
        folder: &Path,
        labels: &[Label],
        recovered: &BTreeSet<u64>,
    ) -> Result<Self, InputError> {
        let Some(name) = section.optional_text("coordinates")? else {
            return Ok(Self { mesh: bare(labels, recovered), placed: false, notes: Vec::new() });
        };
        let path = folder.join(name);
        let failed = |error: &dyn std::fmt::Display| {
            section.failure("coordinates", &error.to_string(), "the path is relative to the structure file")
        };
        let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
        if ["inp", "msh", "bdf", "dat", "nas"].iter().any(|known| extension == *known) {
            let ignored = if section.has("ignore") { section.texts("ignore")? } else { Vec::new() };
            let read = mesh::read_ignoring(&path, &ignored).map_err(|e| failed(&e))?;
            let notes =
                read.warnings.iter().map(|warning| format!("{}: {warning}", path.display())).collect();
            return Ok(Self { mesh: read.mesh, placed: true, notes });
        }
        let positions = iwan_exchange::read_positions(&path).map_err(|e| failed(&e))?;
        let mut mesh = Mesh::default();
        for (label, position) in positions {
            mesh.node_labels.push(label);
            mesh.positions.push(position);
        }
        Ok(Self { mesh, placed: true, notes: Vec::new() })
    }
}

/// A mesh of the nodes of some rows, with ascending numbers, all at the origin.
fn bare(labels: &[Label], recovered: &BTreeSet<u64>) -> Mesh {
    let nodes = labels.iter().filter(|label| label.component != Component::Scalar).map(|label| label.node);
    let mut node_labels: Vec<u64> = nodes.chain(recovered.iter().copied()).collect();
    node_labels.sort_unstable();
    node_labels.dedup();
    Mesh { positions: vec![[0.0; 3]; node_labels.len()], node_labels, ..Mesh::default() }
}

/// The meaning of each row. Nodes of the mesh that have no row are removed from it, with the elements that need them.
pub(super) fn rows(
    section: &Section<'_>,
    places: &mut Places,
    labels: &[Label],
    recovered: &BTreeSet<u64>,
) -> Result<Vec<Row>, InputError> {
    let mut seen: BTreeMap<Label, usize> = BTreeMap::new();
    for (row, label) in labels.iter().enumerate() {
        let scalar = label.component == Component::Scalar;
        if let Some(first) = seen.insert(*label, row).filter(|_| !scalar) {
            let message = format!("row {} is {label}, and so is row {}", row + 1, first + 1);
            return Err(section.failure("rows", &message, "give each row a node and component of its own"));
        }
    }
    let mut wanted: Vec<u64> = labels
        .iter()
        .filter(|l| l.component != Component::Scalar)
        .map(|label| label.node)
        .chain(recovered.iter().copied())
        .collect();
    wanted.sort_unstable();
    wanted.dedup();
    keep(&mut places.mesh, &wanted);
    let index: BTreeMap<u64, usize> =
        places.mesh.node_labels.iter().enumerate().map(|(index, label)| (*label, index)).collect();
    if index.len() != places.mesh.node_labels.len() {
        let message = "a node has two positions";
        return Err(section.failure("coordinates", message, "give each node one line"));
    }
    if let Some(node) = recovered.iter().find(|node| !index.contains_key(node)) {
        let message = format!("node {node} of the recovery matrix has no position");
        return Err(section.failure("coordinates", &message, "give the positions of all nodes"));
    }
    let meaning = |(row, label): (usize, &Label)| {
        if label.component == Component::Scalar {
            return Ok(Row::Generalised);
        }
        let Some(&node) = index.get(&label.node) else {
            let message = format!("row {} is {label}, and that node has no position", row + 1);
            return Err(section.failure(
                "coordinates",
                &message,
                "give the positions of all nodes of the matrices",
            ));
        };
        Ok(match label.component {
            Component::Rotation(axis) => Row::Rotation { node, axis: usize::from(axis) },
            Component::Displacement(axis) => Row::Displacement { node, axis: usize::from(axis) },
            Component::Scalar => Row::Generalised,
        })
    };
    labels.iter().enumerate().map(meaning).collect()
}

/// Removes from a mesh the nodes that are not `wanted` (ascending numbers), with the elements that need them.
fn keep(mesh: &mut Mesh, wanted: &[u64]) {
    let mut new = vec![None; mesh.positions.len()];
    let kept: Vec<usize> = (0..mesh.positions.len())
        .filter(|node| wanted.binary_search(&mesh.node_labels[*node]).is_ok())
        .collect();
    kept.iter().enumerate().for_each(|(number, &node)| new[node] = Some(number));
    mesh.positions = kept.iter().map(|&node| mesh.positions[node]).collect();
    mesh.node_labels = kept.iter().map(|&node| mesh.node_labels[node]).collect();
    let renumber = |nodes: &[usize]| nodes.iter().map(|&node| new[node]).collect::<Option<Vec<usize>>>();
    let mut element_of = vec![None; mesh.elements.len()];
    let mut elements = Vec::new();
    for (index, element) in std::mem::take(&mut mesh.elements).into_iter().enumerate() {
        if let Some(nodes) = renumber(&element.nodes) {
            element_of[index] = Some(elements.len());
            elements.push(mesh::Element { nodes, ..element });
        }
    }
    mesh.elements = elements;
    for set in mesh.node_sets.values_mut() {
        *set = set.iter().filter_map(|&node| new[node]).collect();
    }
    for set in mesh.element_sets.values_mut() {
        *set = set.iter().filter_map(|&element| element_of[element]).collect();
    }
}
