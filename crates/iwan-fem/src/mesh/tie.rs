//! Ties between meshes that do not match: every node of one side follows the point of the other side's faces on which the node lies.

use super::constraint::{Constraint, Rule};
use super::face::{Face, Foot};
use super::topology::Mesh;

/// A tie between two sides.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sides<'a> {
    /// Name, for messages.
    pub(crate) name: &'a str,
    /// Indices of the following nodes.
    pub(crate) nodes: &'a [usize],
    /// Leading faces.
    pub(crate) faces: &'a [Face],
    /// Nodes farther from every face than this are left free, in the user's unit of length; none selects a twentieth of the mean size of
    /// the faces.
    pub(crate) tolerance: Option<f64>,
}

/// Result of a tie.
#[derive(Debug, Clone, Default)]
pub(crate) struct Tied {
    pub(crate) constraints: Vec<Constraint>,
    /// Following nodes, each with the nearest point of its leading face.
    pub(crate) feet: Vec<(usize, [f64; 3])>,
    /// Largest distance between a following node and its face.
    pub(crate) gap: f64,
    /// Nodes that are too far from the faces and stay free.
    pub(crate) free: Vec<usize>,
}

/// Abaqus' default: five per cent of the typical size of the leading faces (Abaqus Analysis User's Guide, "Mesh tie constraints").
const TOLERANCE: f64 = 0.05;

impl Mesh {
    /// Projects the nodes onto the faces. Nodes that themselves belong to a leading face are left as they are.
    ///
    /// Computing time grows with the number of nodes times the number of faces; a test against a box around each face avoids most
    /// projections.
    pub(crate) fn tie(&self, sides: Sides) -> Tied {
        let nodes: Vec<Vec<usize>> = sides.faces.iter().map(|face| face.nodes(self)).collect();
        let boxes: Vec<Bounds> = nodes.iter().map(|nodes| Bounds::around(self, nodes)).collect();
        let mean = boxes.iter().map(Bounds::diagonal).sum::<f64>() / boxes.len().max(1) as f64;
        let tolerance = sides.tolerance.unwrap_or(TOLERANCE * mean);
        // Only faces with mid-edge nodes are curved.
        let with_bulge =
            |(bounds, nodes): (Bounds, &Vec<usize>)| if nodes.len() > 4 { bounds.bulging() } else { bounds };
        let boxes: Vec<Bounds> = boxes.into_iter().zip(&nodes).map(with_bulge).collect();
        let mut leading: Vec<usize> = nodes.into_iter().flatten().collect();
        leading.sort_unstable();
        leading.dedup();
        let mut tied = Tied::default();
        for &node in sides.nodes.iter().filter(|node| leading.binary_search(node).is_err()) {
            let point = self.positions[node];
            let mut best: Option<(Face, Foot)> = None;
            for (face, bounds) in sides.faces.iter().zip(&boxes) {
                let limit = best.as_ref().map_or(tolerance, |(_, foot)| foot.distance);
                if bounds.distance(point) > limit {
                    continue;
                }
                let closer = |foot: &Foot| {
                    foot.distance <= tolerance && best.as_ref().is_none_or(|b| foot.distance < b.1.distance)
                };
                if let Some(foot) = face.nearest(self, point).filter(closer) {
                    best = Some((*face, foot));
                }
            }
            let Some((face, foot)) = best else {
                tied.free.push(node);
                continue;
            };
            tied.gap = tied.gap.max(foot.distance);
            tied.feet.push((node, foot.position));
            let of =
                face.nodes(self).into_iter().zip(foot.values).filter(|(_, value)| *value != 0.0).collect();
            tied.constraints
                .push(Constraint { name: sides.name.into(), rule: Rule::Interpolated { node, of } });
        }
        tied
    }
}

/// A box around a face, parallel to the axes.
struct Bounds {
    low: [f64; 3],
    high: [f64; 3],
}

impl Bounds {
    /// Box around the nodes of a face.
    fn around(mesh: &Mesh, nodes: &[usize]) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for node in nodes {
            for axis in 0..3 {
                low[axis] = low[axis].min(mesh.positions[*node][axis]);
                high[axis] = high[axis].max(mesh.positions[*node][axis]);
            }
        }
        Self { low, high }
    }

    /// The box with a quarter of its size added on each side: a curved face with mid-edge nodes bulges out of the box around its nodes by less.
    fn bulging(mut self) -> Self {
        for axis in 0..3 {
            let bulge = 0.25 * (self.high[axis] - self.low[axis]);
            (self.low[axis], self.high[axis]) = (self.low[axis] - bulge, self.high[axis] + bulge);
        }
        self
    }

    fn diagonal(&self) -> f64 {
        (0..3).map(|a| (self.high[a] - self.low[a]).powi(2)).sum::<f64>().sqrt()
    }

    /// Distance of a point from the box; 0 inside the box.
    fn distance(&self, point: [f64; 3]) -> f64 {
        (0..3)
            .map(|a| (self.low[a] - point[a]).max(point[a] - self.high[a]).max(0.0).powi(2))
            .sum::<f64>()
            .sqrt()
    }
}
