//! Meshes of tetrahedra and wedges, cut from bricks.
#![allow(dead_code, reason = "every test file uses some of these")]

use std::collections::BTreeMap;

use iwan_fem::mesh::{Element, Mesh, Shape};

/// Six tetrahedra around the diagonal 0-6.
const TETRAHEDRA: &[&[usize]] =
    &[&[0, 1, 2, 6], &[0, 2, 3, 6], &[0, 3, 7, 6], &[0, 7, 4, 6], &[0, 4, 5, 6], &[0, 5, 1, 6]];
/// Two wedges.
const WEDGES: &[&[usize]] = &[&[0, 1, 2, 4, 5, 6], &[0, 2, 3, 4, 6, 7]];

/// Cuts all bricks into tetrahedra or wedges, for shapes with and without mid-edge nodes; bricks stay bricks.
pub(crate) fn cut(mesh: &mut Mesh, shape: Shape) {
    some_cut(mesh, shape, |_| true);
}

/// Cuts the columns of bricks whose number in the lowest layer is `chosen`, such that the pieces of neighbouring bricks fit together.
pub(crate) fn some_cut(mesh: &mut Mesh, shape: Shape, chosen: impl Fn(usize) -> bool) {
    let (pieces, shape) = match shape.corners() {
        4 => (TETRAHEDRA, Shape::Tet4),
        6 => (WEDGES, Shape::Wedge6),
        _ => return,
    };
    let bricks = std::mem::take(&mut mesh.elements);
    let bottom =
        |brick: &Element| brick.nodes[..4].iter().map(|n| mesh.positions[*n][2]).fold(f64::MIN, f64::max);
    let lowest = bricks.iter().map(&bottom).fold(f64::MAX, f64::min);
    let layer = bricks.iter().filter(|brick| bottom(brick) < lowest + 1e-9).count();
    let mut elements: Vec<(Shape, Vec<usize>)> = Vec::new();
    for (index, brick) in bricks.iter().enumerate() {
        if chosen(index % layer) {
            let of = |piece: &&[usize]| (shape, piece.iter().map(|at| brick.nodes[*at]).collect());
            elements.extend(pieces.iter().map(of));
        } else {
            elements.push((brick.shape, brick.nodes.clone()));
        }
    }
    let label = |(label, (shape, nodes))| Element { label, shape, nodes };
    mesh.elements = (1..).zip(elements).map(label).collect();
}

/// Adds a node in the middle of every edge if `shape` has such nodes.
pub(crate) fn with_middles(mesh: &mut Mesh, shape: Shape) {
    if !shape.has_middles() {
        return;
    }
    let mut middles: BTreeMap<(usize, usize), usize> = BTreeMap::new();
    for element in &mut mesh.elements {
        for (a, b) in element.shape.edges() {
            let (a, b) = (element.nodes[*a], element.nodes[*b]);
            let node = *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                let (p, q) = (mesh.positions[a], mesh.positions[b]);
                mesh.positions.push(std::array::from_fn(|i| 0.5 * (p[i] + q[i])));
                mesh.node_labels.push(mesh.positions.len() as u64);
                mesh.positions.len() - 1
            });
            element.nodes.push(node);
        }
        element.shape = match element.shape.corners() {
            4 => Shape::Tet10,
            6 => Shape::Wedge15,
            _ => Shape::Hex20,
        };
    }
}
