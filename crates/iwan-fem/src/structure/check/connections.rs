//! Checks of ties and joints.

use std::collections::BTreeMap;

use super::super::interface::{Interface, Patch};
use super::finding::{Defect, Findings, Remark, list};
use super::link::Link;
use super::nodes::{COINCIDENT, distance};
use crate::mesh::Mesh;

/// Nodes count as lying on a line when none is farther from it than this share of its length. The limit is far above the rounding of a file
/// with six digits and far below the intended width of a patch. Beyond it the patch determines the rotation about the line, even if
/// inaccurately.
const ON_A_LINE: f64 = 1e-3;
/// Gap between the two sides of a joint, as a share of the smaller side, above which a remark is made, because the joint then bridges the
/// gap rigidly. A gap larger than the smaller side is a defect. Faces that touch have no gap.
const GAP: f64 = 0.1;

/// A link (tie or joint) under examination.
struct Case<'a> {
    mesh: &'a Mesh,
    link: &'a Link<'a>,
    findings: &'a mut Findings,
}

/// Checks each link by itself, then all together.
pub(super) fn check(mesh: &Mesh, sizes: &[f64], links: &[Link], findings: &mut Findings) {
    for link in links {
        let mut case = Case { mesh, link, findings };
        if case.sides_are_apart() {
            match link.interface {
                Interface::Whole(_) => case.interface(),
                Interface::NodeToNode => case.pairs(sizes),
                Interface::Directions => {}
            }
        }
    }
    followers(mesh, links, findings);
}

impl Case<'_> {
    fn defect(&mut self, reason: String, remedy: &'static str) {
        let name = self.link.name.clone();
        self.findings.defects.push(Defect::Link { name, reason, remedy });
    }

    fn remark(&mut self, reason: String) {
        self.findings.remarks.push(Remark::Link { name: self.link.name.clone(), reason });
    }

    fn labels(&self, nodes: &[usize]) -> String {
        list(nodes, |node| self.mesh.node_labels[*node].to_string())
    }

    /// Whether both sides have nodes and no node in common. Empty sets are reported elsewhere.
    fn sides_are_apart(&mut self) -> bool {
        let (face, patch) = (self.link.face, self.link.patch);
        let mut sorted = patch.to_vec();
        sorted.sort_unstable();
        let common: Vec<usize> = face.iter().copied().filter(|n| sorted.binary_search(n).is_ok()).collect();
        if !common.is_empty() {
            let reason = format!("face and patch share the nodes {}", self.labels(&common));
            self.defect(reason, "the two sides need nodes of their own: do not merge them when meshing");
        }
        common.is_empty() && !face.is_empty() && !patch.is_empty()
    }

    fn interface(&mut self) {
        let (face, patch) = (self.link.face, self.link.patch);
        let remedy = "take at least three nodes that are not on one line, such as all nodes of the footprint";
        if patch.len() < 3 {
            let reason =
                format!("its patch has only the nodes {}: their motion has no rotation", self.labels(patch));
            return self.defect(reason, remedy);
        }
        if on_a_line(self.mesh, patch) {
            let reason = format!(
                "the nodes of its patch are on one line ({}): it has no rotation about it",
                self.labels(patch)
            );
            return self.defect(reason, remedy);
        }
        if face.len() < 3 || on_a_line(self.mesh, face) {
            let nodes = self.labels(face);
            self.remark(format!(
                "the nodes of its face ({nodes}) are on one line: the part can turn about it"
            ));
        }
        let (gap, a, b) = nearest(self.mesh, face, patch);
        let size = extent(self.mesh, face).min(extent(self.mesh, patch));
        let between =
            format!("(between nodes {} and {})", self.mesh.node_labels[a], self.mesh.node_labels[b]);
        if gap > size {
            let reason = format!("face and patch are {gap:.3e} apart {between}, farther than either is wide");
            self.defect(reason, "name sets that face each other");
        } else if gap > GAP * size {
            self.remark(format!("face and patch are {gap:.3e} apart {between}"));
        }
    }

    fn pairs(&mut self, sizes: &[f64]) {
        let alone = |node: &usize| {
            let (gap, _, other) = nearest(self.mesh, &[*node], self.link.patch);
            gap > COINCIDENT * sizes[*node].min(sizes[other])
        };
        let alone: Vec<usize> = self.link.face.iter().copied().filter(alone).collect();
        if !alone.is_empty() {
            let reason = format!(
                "the nodes {} of its face have no node of the patch at their place",
                self.labels(&alone)
            );
            self.defect(reason, "let the meshes match there, or use a joint of the whole interface");
        }
    }
}

/// Reports nodes that follow more than one link; a node can follow only one.
fn followers(mesh: &Mesh, links: &[Link], findings: &mut Findings) {
    let mut leaders: BTreeMap<usize, &str> = BTreeMap::new();
    for link in links {
        let rigid = if link.interface == Interface::Whole(Patch::Rigid) { link.patch } else { &[] };
        let mut nodes = link.face.iter().chain(rigid);
        if let Some((node, other)) = nodes.find_map(|node| Some((*node, leaders.insert(*node, &link.name)?)))
        {
            let (name, node) = (link.name.clone(), mesh.node_labels[node]);
            let reason = format!("its node {node} follows {other} already");
            let remedy =
                "give each tie or joint nodes of its own; patches that share nodes must be averaging";
            findings.defects.push(Defect::Link { name, reason, remedy });
        }
    }
}

/// Whether all nodes lie on one line or at one point.
fn on_a_line(mesh: &Mesh, nodes: &[usize]) -> bool {
    let at = |node: &usize| mesh.positions[*node];
    let first = at(&nodes[0]);
    let Some(far) = nodes.iter().map(at).max_by(|a, b| distance(first, *a).total_cmp(&distance(first, *b)))
    else {
        return true;
    };
    let length = distance(first, far);
    let along: [f64; 3] = std::array::from_fn(|axis| (far[axis] - first[axis]) / length);
    let off = |position: [f64; 3]| {
        let arm: [f64; 3] = std::array::from_fn(|axis| position[axis] - first[axis]);
        let share: f64 = arm.iter().zip(along).map(|(a, b)| a * b).sum();
        distance(arm, along.map(|a| a * share))
    };
    length == 0.0 || nodes.iter().map(at).all(|position| off(position) <= ON_A_LINE * length)
}

/// Length of the diagonal of the box around the nodes.
fn extent(mesh: &Mesh, nodes: &[usize]) -> f64 {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for node in nodes {
        for (axis, x) in mesh.positions[*node].into_iter().enumerate() {
            low[axis] = low[axis].min(x);
            high[axis] = high[axis].max(x);
        }
    }
    distance(low, high)
}

/// The smallest distance between the two sides, and the two nodes between which it lies.
fn nearest(mesh: &Mesh, face: &[usize], patch: &[usize]) -> (f64, usize, usize) {
    let pairs = face.iter().flat_map(|a| patch.iter().map(move |b| (*a, *b)));
    pairs.fold((f64::INFINITY, face[0], patch[0]), |best, (a, b)| {
        let gap = distance(mesh.positions[a], mesh.positions[b]);
        if gap < best.0 { (gap, a, b) } else { best }
    })
}
