//! Brick-shaped blocks of hexahedra on given mesh lines.

use std::collections::HashMap;

use super::topology::{Element, Mesh, Shape};

/// Mesh lines in x, y and z, each ascending.
pub type Lines = [Vec<f64>; 3];

/// `cells` equal cells between `from` and `to`: `cells` + 1 lines.
///
/// ```
/// assert_eq!(iwan_fem::mesh::block::uniform(0.0, 1.0, 4), [0.0, 0.25, 0.5, 0.75, 1.0]);
/// ```
#[must_use]
pub fn uniform(from: f64, to: f64, cells: usize) -> Vec<f64> {
    (0..=cells).map(|i| from + (to - from) * i as f64 / cells as f64).collect()
}

/// Mesh lines in which each cell between neighbouring `lines` is cut into `parts` equal cells.
#[must_use]
pub fn refined(lines: &[f64], parts: usize) -> Vec<f64> {
    let cells = lines.windows(2).flat_map(|w| uniform(w[0], w[1], parts).into_iter().take(parts));
    cells.chain(lines.last().copied()).collect()
}

/// A mesh of one block, with the element set `block`.
///
/// ```
/// use iwan_fem::mesh::block::{block, uniform};
/// let mesh = block(&[uniform(0.0, 2.0, 4), uniform(0.0, 1.0, 2), uniform(0.0, 1.0, 2)]);
/// assert_eq!((mesh.positions.len(), mesh.elements.len()), (45, 16));
/// ```
#[must_use]
pub fn block(lines: &Lines) -> Mesh {
    let mut part = Part::default();
    let mut mesh = Mesh::default();
    part.add(&mut mesh, "block", lines);
    mesh
}

/// A connected part of a mesh: blocks that share the nodes at equal positions.
#[derive(Debug, Default)]
pub(super) struct Part {
    nodes: HashMap<[i64; 3], usize>,
}

impl Part {
    /// Adds a block to the mesh and its elements to a set.
    pub(super) fn add(&mut self, mesh: &mut Mesh, set: &str, lines: &Lines) {
        let [x, y, z] = lines;
        let first = mesh.elements.len();
        for k in 1..z.len() {
            for j in 1..y.len() {
                for i in 1..x.len() {
                    let corner = [(0, 0), (1, 0), (1, 1), (0, 1)];
                    let bottom = corner.map(|(a, b)| [x[i - 1 + a], y[j - 1 + b], z[k - 1]]);
                    let top = bottom.map(|p| [p[0], p[1], z[k]]);
                    let nodes = bottom.iter().chain(&top).map(|&p| self.node(mesh, p)).collect();
                    let label = mesh.elements.len() as u64 + 1;
                    mesh.elements.push(Element { label, shape: Shape::Hex8, nodes });
                }
            }
        }
        mesh.element_sets.entry(set.to_owned()).or_default().extend(first..mesh.elements.len());
    }

    /// The node at a position, which is created if there is none.
    fn node(&mut self, mesh: &mut Mesh, at: [f64; 3]) -> usize {
        // Positions on equal mesh lines differ by rounding at most. They count as equal to 1e-9 of the unit of length, which is far below
        // the cells of any block given in that unit.
        let key = at.map(|c| (c * 1e9).round() as i64);
        *self.nodes.entry(key).or_insert_with(|| {
            mesh.positions.push(at);
            mesh.node_labels.push(mesh.positions.len() as u64);
            mesh.positions.len() - 1
        })
    }
}
