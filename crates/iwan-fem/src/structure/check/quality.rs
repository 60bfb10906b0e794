//! Checks of single elements: shape and nodes.

use super::finding::{Defect, Findings, Remark};
use super::nodes::edges;
use crate::element::{corner_quality, least_quality_inside};
use crate::mesh::{Element, Mesh, Shape};

/// Limit below which a scaled determinant, or a ratio of edge lengths, counts as zero. Two edges at an angle of 0.06 thousandths of a
/// degree have a scaled determinant of 1e-6, which no mesh generator intends. Files with seven digits round to 1e-7 of the coordinates.
const NONE: f64 = 1e-6;
/// Scaled determinant below which an element is reported as badly distorted, in a remark that refuses nothing. 0.1 is an angle of six
/// degrees between edges.
const POOR: f64 = 0.1;

#[derive(Default)]
struct Lists {
    inverted: Vec<u64>,
    collapsed: Vec<u64>,
    corners: Vec<(u64, u64)>,
    repeated: Vec<(u64, u64)>,
    distorted: Vec<(u64, f64)>,
}

/// Checks the shape of every element, and finds elements with the same nodes.
pub(super) fn check(mesh: &Mesh, findings: &mut Findings) {
    if mesh.elements.is_empty() {
        findings.defects.push(Defect::Empty);
    }
    let mut linear = mesh.elements.iter().filter(|element| element.shape == Shape::Tet4);
    if let Some(first) = linear.next() {
        findings.remarks.push(Remark::Stiff { count: 1 + linear.count(), element: first.label });
    }
    let mut lists = Lists::default();
    for element in &mesh.elements {
        lists.examine(mesh, element);
    }
    let pairs = same_nodes(mesh);
    let defects = &mut findings.defects;
    let mut add = |there: bool, defect: Defect| {
        if there {
            defects.push(defect);
        }
    };
    add(!lists.repeated.is_empty(), Defect::RepeatedNode { elements: lists.repeated });
    add(!lists.inverted.is_empty(), Defect::Inverted { elements: lists.inverted });
    add(!lists.collapsed.is_empty(), Defect::Collapsed { elements: lists.collapsed });
    add(!lists.corners.is_empty(), Defect::BadCorner { corners: lists.corners });
    add(!pairs.is_empty(), Defect::SameNodes { pairs });
    if !lists.distorted.is_empty() {
        findings.remarks.push(Remark::Distorted { elements: lists.distorted });
    }
}

impl Lists {
    fn examine(&mut self, mesh: &Mesh, element: &Element) {
        if let Some(node) = repeated(&element.nodes) {
            self.repeated.push((element.label, mesh.node_labels[node]));
            return;
        }
        let positions: Vec<[f64; 3]> = element.nodes.iter().map(|n| mesh.positions[*n]).collect();
        let corners = corner_quality(element.shape, &positions);
        let inside = least_quality_inside(element.shape, &positions);
        let (worst, least) = corners
            .iter()
            .enumerate()
            .fold((0, f64::INFINITY), |worst, (corner, j)| if *j < worst.1 { (corner, *j) } else { worst });
        if corners.iter().all(|j| *j < -NONE) {
            self.inverted.push(element.label);
        } else if inside <= NONE || is_flat(mesh, element) {
            self.collapsed.push(element.label);
        } else if least <= NONE {
            self.corners.push((element.label, mesh.node_labels[element.nodes[worst]]));
        } else if least.min(inside) < POOR {
            self.distorted.push((element.label, least.min(inside)));
        }
    }
}

/// Whether an edge has practically no length compared with the longest.
fn is_flat(mesh: &Mesh, element: &Element) -> bool {
    let lengths = edges(mesh, element);
    let longest = lengths.clone().fold(0.0, f64::max);
    lengths.into_iter().any(|length| length <= NONE * longest)
}

/// A node that occurs twice in an element, if there is one.
fn repeated(nodes: &[usize]) -> Option<usize> {
    nodes.iter().enumerate().find(|(at, node)| nodes[..*at].contains(node)).map(|(_, node)| *node)
}

/// Pairs of elements with the same nodes in any order.
fn same_nodes(mesh: &Mesh) -> Vec<(u64, u64)> {
    let sorted = |element: &Element| {
        let mut nodes = element.nodes.clone();
        nodes.sort_unstable();
        (nodes, element.label)
    };
    let mut keys: Vec<_> = mesh.elements.iter().map(sorted).collect();
    keys.sort_unstable();
    keys.windows(2).filter(|w| w[0].0 == w[1].0).map(|w| (w[0].1, w[1].1)).collect()
}
