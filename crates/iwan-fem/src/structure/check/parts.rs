//! Parts of a mesh: the sets of nodes that elements connect, and that ties and joints connect further.

use super::finding::{Defect, Findings};
use super::link::Link;
use crate::mesh::{Constraint, Mesh, Rule};

/// The parts of a mesh, by elements alone: sets of nodes that elements connect.
pub(super) struct Parts {
    /// Part of each node, named by the index of one of the part's nodes; none for nodes without an element.
    of_node: Vec<Option<usize>>,
}

/// Disjoint sets with path halving (union-find).
struct Forest {
    parent: Vec<usize>,
}

impl Forest {
    fn new(length: usize) -> Self {
        Self { parent: (0..length).collect() }
    }

    fn root(&mut self, mut node: usize) -> usize {
        while self.parent[node] != node {
            self.parent[node] = self.parent[self.parent[node]];
            node = self.parent[node];
        }
        node
    }

    /// Joins two sets; the smaller index stays the root, so that the result does not depend on the order.
    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a.max(b)] = a.min(b);
    }
}

impl Parts {
    /// The parts that elements alone connect.
    pub(super) fn new(mesh: &Mesh) -> Self {
        let mut forest = Forest::new(mesh.positions.len());
        let mut used = vec![false; mesh.positions.len()];
        for element in &mesh.elements {
            for node in &element.nodes {
                used[*node] = true;
                forest.join(element.nodes[0], *node);
            }
        }
        let of_node = used.iter().enumerate().map(|(node, used)| used.then(|| forest.root(node))).collect();
        Self { of_node }
    }

    /// Part of a node; none for a node without an element.
    pub(super) fn of(&self, node: usize) -> Option<usize> {
        self.of_node[node]
    }
}

/// Reports the parts that no tie or joint connects with the rest; the part with most elements counts as the rest.
pub(super) fn unconnected(
    mesh: &Mesh,
    parts: &Parts,
    pairs: &[(usize, usize)],
    (links, constraints): (&[Link], &[Constraint]),
    findings: &mut Findings,
) {
    let mut forest = Forest::new(mesh.positions.len());
    for (node, part) in parts.of_node.iter().enumerate() {
        forest.join(node, part.unwrap_or(node));
    }
    for link in links {
        let mut nodes = link.face.iter().chain(link.patch);
        if let (false, Some(first)) = (link.face.is_empty() || link.patch.is_empty(), nodes.next()) {
            nodes.for_each(|node| forest.join(*first, *node));
        }
    }
    for constraint in constraints.iter().filter(|c| !matches!(c.rule, Rule::Held(_))) {
        let nodes = constraint.nodes();
        nodes.iter().skip(1).for_each(|node| forest.join(nodes[0], *node));
    }
    let mut elements = vec![(0, 0); mesh.positions.len()];
    for element in mesh.elements.iter().rev() {
        let entry = &mut elements[forest.root(element.nodes[0])];
        *entry = (entry.0 + 1, element.label);
    }
    let largest = (0..elements.len()).max_by_key(|root| (elements[*root].0, std::cmp::Reverse(*root)));
    for (root, (count, element)) in elements.into_iter().enumerate() {
        if count == 0 || Some(root) == largest {
            continue;
        }
        let mut touches = |(a, b): (usize, usize)| forest.root(a) == root && forest.root(b) != root;
        let both = pairs.iter().flat_map(|(a, b)| [(*a, *b), (*b, *a)]);
        let touching = both.into_iter().find(|pair| touches(*pair));
        let touching = touching.map(|(a, b)| (mesh.node_labels[a], mesh.node_labels[b]));
        findings.defects.push(Defect::Unconnected { elements: count, element, touching });
    }
}
