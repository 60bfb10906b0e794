//! `GRID`: nodes, and the coordinate systems of their components.

use super::super::constraint::GLOBAL;
use super::super::error::MeshError;
use super::super::file::FileBytes;
use super::super::labels::{Labels, Twice};
use super::super::topology::Mesh;
use super::card::Card;
use super::reader::Reader;
use super::systems::{System, Systems};

/// Nodes with their numbers.
pub(super) struct Grids {
    pub(super) labels: Labels,
    /// System of the components of each node; none for global axes.
    systems: Vec<Option<System>>,
    /// Components that are held permanently (field PS), with the line.
    pub(super) held: Vec<(usize, [bool; 6], usize)>,
}

impl Grids {
    /// Reads all nodes into the mesh.
    pub(super) fn read(
        source: FileBytes,
        reader: &Reader,
        systems: &Systems,
        mesh: &mut Mesh,
    ) -> Result<Self, MeshError> {
        let (mut used, mut held) = (Vec::new(), Vec::new());
        for card in &reader.grids {
            // An empty field has the value of GRDSET, whose fields are at the same places.
            let filled = |at: usize| match (&reader.defaults, card.field(at)) {
                (Some(defaults), "") => defaults,
                _ => card,
            };
            let system = |at: usize| -> Result<(i64, System), MeshError> {
                let number = filled(at).integer(source, at, Some(0))?;
                let known = systems.get(&number).copied().map(|system| (number, system));
                known.ok_or_else(|| {
                    card.malformed(
                        source,
                        format!("system {number} in field {}", at + 2),
                        "the number of a CORD2R, CORD2C or CORD2S",
                    )
                })
            };
            let mut position = [0.0; 3];
            for (axis, value) in position.iter_mut().enumerate() {
                *value = card.real(source, 2 + axis, Some(0.0))?;
            }
            let node = mesh.positions.len();
            mesh.positions.push(system(1)?.1.global(position));
            mesh.node_labels.push(card.label(source, 0)?);
            let (number, components) = system(5)?;
            used.push((number != 0).then_some(components));
            let permanent = filled(6).components(source, 6)?;
            if permanent.contains(&true) {
                held.push((node, permanent, card.line));
            }
        }
        let labels =
            Labels::new(mesh.node_labels.iter().copied()).map_err(|Twice { label, second, .. }| {
                reader.grids[second].malformed(
                    source,
                    format!("node {label} twice"),
                    "a number of its own for every node",
                )
            })?;
        Ok(Self { labels, systems: used, held })
    }

    /// Index of the node whose number is in a field.
    pub(super) fn node(&self, source: FileBytes, card: &Card, at: usize) -> Result<usize, MeshError> {
        let label = card.label(source, at)?;
        self.labels.index(label).ok_or_else(|| {
            card.malformed(source, format!("node {label} in field {}", at + 2), "the number of a GRID")
        })
    }

    /// Directions of the components of a node.
    pub(super) fn directions(&self, mesh: &Mesh, node: usize) -> [[f64; 3]; 3] {
        self.systems[node].map_or(GLOBAL, |system| system.directions(mesh.positions[node]))
    }
}
