//! Positions of points and lines between them for drawings: from the table of points, or from universal files.

use std::path::Path;

use iwan_input::{ModalTable, PointEntry};
use iwan_io::{ROD, UffModel};

use crate::failure::Failure;
use crate::shown;

/// Points with positions, and the lines and elements between them.
#[derive(Debug, Clone, Default)]
pub(super) struct Geometry {
    pub(super) points: Vec<PointEntry>,
    /// Pairs of points that a line joins in drawings.
    pub(super) edges: Vec<[String; 2]>,
    /// The same lines for programs that know elements only: elements as given, lines as rods.
    pub(super) elements: Vec<Element>,
}

/// An element: the code of its kind in universal files, and the names of its points.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Element {
    pub(super) kind: i64,
    pub(super) points: Vec<String>,
}

impl Element {
    fn rod(ends: &[String; 2]) -> Self {
        Self { kind: ROD, points: ends.to_vec() }
    }
}

/// Whether bytes begin as universal files do: the first line that is not empty is `-1`.
pub(super) fn is_universal(bytes: &[u8]) -> bool {
    let first = bytes.split(|b| *b == b'\n').map(<[u8]>::trim_ascii).find(|line| !line.is_empty());
    first == Some(b"-1")
}

impl Geometry {
    /// The geometry that a table of points gives.
    pub(super) fn of_table(table: &ModalTable) -> Self {
        let pairs = |line: &Vec<String>| -> Vec<[String; 2]> {
            line.windows(2).map(|w| [w[0].clone(), w[1].clone()]).collect()
        };
        let edges: Vec<[String; 2]> = table.lines.iter().flat_map(pairs).collect();
        Self { points: table.points.clone(), elements: edges.iter().map(Element::rod).collect(), edges }
    }

    /// Adds the points of a universal file that are not known yet; returns messages on what was left out of the file.
    pub(super) fn add(&mut self, path: &Path, bytes: &[u8]) -> Result<Vec<String>, Failure> {
        let name = shown::path(path);
        let model = iwan_io::uff_model(path, bytes).map_err(|e| Failure::said(&name, &e))?;
        for node in &model.nodes {
            let own = node.number.to_string();
            if self.points.iter().all(|p| p.name != own) {
                self.points.push(PointEntry { name: own, position: node.position });
            }
        }
        for (kind, nodes) in &model.elements {
            let points = nodes.iter().map(ToString::to_string).collect();
            self.elements.push(Element { kind: *kind, points });
        }
        let lines = UffModel { elements: Vec::new(), ..model.clone() }.edges();
        self.elements.extend(lines.iter().map(|edge| Element::rod(&edge.map(|n| n.to_string()))));
        for edge in model.edges() {
            let edge = edge.map(|n| n.to_string());
            if !self.edges.contains(&edge) {
                self.edges.push(edge);
            }
        }
        Ok(model.warnings.iter().map(|w| format!("{name}: {w}")).collect())
    }

    /// Position of a point; none where it is not known.
    pub(super) fn position(&self, point: &str) -> Option<[f64; 3]> {
        self.points.iter().find(|p| p.name == point).map(|p| p.position)
    }
}
