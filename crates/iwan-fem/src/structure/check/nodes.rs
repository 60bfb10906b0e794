//! Checks of nodes: nodes without elements, and nodes at the same place.

use std::collections::{BTreeMap, BTreeSet};

use super::super::description::Structure;
use super::finding::{Defect, Findings, Remark};
use super::link::Link;
use super::parts::Parts;
use crate::mesh::{Constraint, Element, Mesh};

/// Two nodes closer than this share of the shortest edge at either count as at the same place. Files with six digits round much less, and
/// no sound element is so thin.
pub const COINCIDENT: f64 = 1e-3;

/// Reports nodes that belong to no element and to no constraint.
pub(super) fn orphans(structure: &Structure, parts: &Parts, findings: &mut Findings) {
    let mesh = &structure.mesh;
    let mentioned: BTreeSet<usize> = structure.constraints.iter().flat_map(Constraint::nodes).collect();
    let alone =
        (0..mesh.positions.len()).filter(|node| parts.of(*node).is_none() && !mentioned.contains(node));
    let nodes: Vec<u64> = alone.map(|node| mesh.node_labels[node]).collect();
    if !nodes.is_empty() {
        findings.defects.push(Defect::Orphans { nodes });
    }
}

/// Lengths of the edges of an element, from corner to corner.
pub(super) fn edges(mesh: &Mesh, element: &Element) -> impl Iterator<Item = f64> + Clone {
    let at = |corner: usize| mesh.positions[element.nodes[corner]];
    element.shape.edges().iter().map(move |&(a, b)| distance(at(a), at(b)))
}

/// For each node the shortest edge length (or half of it, with middle nodes) of its elements; infinite for nodes without an element.
pub(super) fn sizes(mesh: &Mesh) -> Vec<f64> {
    let mut sizes = vec![f64::INFINITY; mesh.positions.len()];
    for element in &mesh.elements {
        let share = if element.shape.has_middles() { 0.5 } else { 1.0 };
        let lengths = edges(mesh, element).filter(|length| *length > 0.0);
        let shortest = share * lengths.fold(f64::INFINITY, f64::min);
        for node in &element.nodes {
            sizes[*node] = sizes[*node].min(shortest);
        }
    }
    sizes
}

pub(super) fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum::<f64>().sqrt()
}

/// Pairs of nodes at the same place, the smaller index first, ascending.
pub(super) fn coincident(mesh: &Mesh, sizes: &[f64]) -> Vec<(usize, usize)> {
    let largest = sizes.iter().copied().filter(|s| s.is_finite()).fold(0.0, f64::max);
    let width = COINCIDENT * largest;
    if width <= 0.0 {
        return Vec::new();
    }
    // Nodes are sorted by cells as wide as the largest tolerance; a node's partners are in its own cell or in a neighbouring one.
    let cell = |position: [f64; 3]| position.map(|x| (x / width).floor() as i64);
    let mut cells: Vec<([i64; 3], usize)> =
        (0..mesh.positions.len()).map(|node| (cell(mesh.positions[node]), node)).collect();
    cells.sort_unstable();
    let mut pairs = Vec::new();
    for (own, node) in &cells {
        for dx in -1..=1 {
            for dy in -1..=1 {
                let line = [own[0].saturating_add(dx), own[1].saturating_add(dy)];
                let from = [line[0], line[1], own[2].saturating_sub(1)];
                let to = [line[0], line[1], own[2].saturating_add(1)];
                let start = cells.partition_point(|entry| entry.0 < from);
                let near = cells[start..].iter().take_while(|entry| entry.0 <= to).map(|entry| entry.1);
                pairs.extend(near.filter(|other| node < other).map(|other| (*node, other)));
            }
        }
    }
    let close = |(a, b): &(usize, usize)| {
        distance(mesh.positions[*a], mesh.positions[*b]) <= COINCIDENT * sizes[*a].min(sizes[*b])
    };
    pairs.retain(close);
    pairs.sort_unstable();
    pairs
}

/// Reports pairs that no link or constraint explains: a defect within a part, a remark between two parts.
pub(super) fn report(
    mesh: &Mesh,
    parts: &Parts,
    pairs: &[(usize, usize)],
    (links, constraints): (&[Link], &[Constraint]),
    findings: &mut Findings,
) {
    let mut linked = linked(pairs, links);
    linked.extend(constrained(pairs, constraints));
    let label = |(a, b): &(usize, usize)| (mesh.node_labels[*a], mesh.node_labels[*b]);
    let whole = |(a, b): &&(usize, usize)| parts.of(*a).is_some() && parts.of(*b).is_some();
    let open = pairs.iter().filter(|pair| !linked.contains(pair)).filter(whole);
    let (same, other): (Vec<_>, Vec<_>) = open.partition(|(a, b)| parts.of(*a) == parts.of(*b));
    if !same.is_empty() {
        findings.defects.push(Defect::Coincident { pairs: same.into_iter().map(label).collect() });
    }
    if !other.is_empty() {
        findings.remarks.push(Remark::Touching { pairs: other.into_iter().map(label).collect() });
    }
}

/// The pairs whose two nodes lie on the two sides of a link.
fn linked<'a>(pairs: &'a [(usize, usize)], links: &[Link]) -> BTreeSet<&'a (usize, usize)> {
    let sides: Vec<(BTreeSet<usize>, BTreeSet<usize>)> = links
        .iter()
        .map(|link| (link.face.iter().copied().collect(), link.patch.iter().copied().collect()))
        .collect();
    let across = |pair: &&(usize, usize)| {
        let (a, b) = **pair;
        sides.iter().any(|(face, patch)| {
            (face.contains(&a) && patch.contains(&b)) || (face.contains(&b) && patch.contains(&a))
        })
    };
    pairs.iter().filter(across).collect()
}

/// The pairs whose nodes both belong to one constraint.
fn constrained<'a>(pairs: &'a [(usize, usize)], constraints: &[Constraint]) -> Vec<&'a (usize, usize)> {
    // The constraints of each node that occurs in a pair; few nodes do.
    let mut of: BTreeMap<usize, BTreeSet<usize>> =
        pairs.iter().flat_map(|(a, b)| [(*a, BTreeSet::new()), (*b, BTreeSet::new())]).collect();
    for (index, constraint) in constraints.iter().enumerate() {
        for node in constraint.nodes() {
            if let Some(known) = of.get_mut(&node) {
                known.insert(index);
            }
        }
    }
    pairs.iter().filter(|(a, b)| !of[a].is_disjoint(&of[b])).collect()
}
