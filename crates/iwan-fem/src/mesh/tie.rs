//! Ties between meshes that do not match: every node of one side follows the point of the other side's faces on which it lies.

use super::constraint::{Constraint, Rule};
use super::face::{Face, Foot};
use super::topology::Mesh;

/// A tie between two sides.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sides<'a> {
    /// Name for errors.
    pub(crate) name: &'a str,
    /// Indices of the nodes that follow.
    pub(crate) nodes: &'a [usize],
    /// Faces that lead.
    pub(crate) faces: &'a [Face],
    /// Nodes farther than this from every face are left free; none for a twentieth of the faces' mean size.
    pub(crate) tolerance: Option<f64>,
}

/// What a tie found.
#[derive(Debug, Clone, Default)]
pub(crate) struct Tied {
    pub(crate) constraints: Vec<Constraint>,
    /// Nodes that follow, with the points of the faces below them.
    pub(crate) feet: Vec<(usize, [f64; 3])>,
    /// Largest distance between a node that follows and its face.
    pub(crate) gap: f64,
    /// Nodes that are too far from the faces.
    pub(crate) free: Vec<usize>,
}

/// Abaqus' default: five per cent of the typical size of the leading facets (Abaqus Analysis User's Guide, "Mesh tie constraints").
const TOLERANCE: f64 = 0.05;

impl Mesh {
    /// Projects the nodes onto the faces. Nodes that belong to a leading face themselves stay as they are.
    ///
    /// Time grows with the product of both sides, after a look at boxes around the faces.
    pub(crate) fn tie(&self, sides: Sides) -> Tied {
        let boxes: Vec<Bounds> = sides.faces.iter().map(|face| Bounds::of(self, *face)).collect();
        let mean = boxes.iter().map(Bounds::diagonal).sum::<f64>() / boxes.len().max(1) as f64;
        let tolerance = sides.tolerance.unwrap_or(TOLERANCE * mean);
        let mut leading: Vec<usize> = sides.faces.iter().flat_map(|face| face.nodes(self)).collect();
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

/// A box around a face.
struct Bounds {
    low: [f64; 3],
    high: [f64; 3],
}

impl Bounds {
    /// Curved faces bulge out of the box of their nodes by less than a quarter of it.
    fn of(mesh: &Mesh, face: Face) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        let nodes = face.nodes(mesh);
        for node in &nodes {
            for axis in 0..3 {
                low[axis] = low[axis].min(mesh.positions[*node][axis]);
                high[axis] = high[axis].max(mesh.positions[*node][axis]);
            }
        }
        if nodes.len() > 4 {
            for axis in 0..3 {
                let bulge = 0.25 * (high[axis] - low[axis]);
                (low[axis], high[axis]) = (low[axis] - bulge, high[axis] + bulge);
            }
        }
        Self { low, high }
    }

    fn diagonal(&self) -> f64 {
        (0..3).map(|a| (self.high[a] - self.low[a]).powi(2)).sum::<f64>().sqrt()
    }

    /// Distance of a point from the box; 0 inside.
    fn distance(&self, point: [f64; 3]) -> f64 {
        (0..3)
            .map(|a| (self.low[a] - point[a]).max(point[a] - self.high[a]).max(0.0).powi(2))
            .sum::<f64>()
            .sqrt()
    }
}
