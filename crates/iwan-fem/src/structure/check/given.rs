//! Checks of given matrices: whether they can be a stiffness and a mass, and whether the joints fit them.

use super::super::description::Structure;
use super::super::given::{Given, RelativeSlip, Row};
use super::super::interface::Interface;
use super::connections;
use super::finding::{Defect, Findings, Remark};
use super::link::{Link, links};
use crate::algebra::Symmetric;
use crate::mesh::Mesh;

/// Part by which an entry may exceed the geometric mean of its two diagonal entries. In a semi-definite matrix it never exceeds that mean,
/// but files contain rounded numbers; a single-precision file leaves 1e-7.
const ROUNDED: f64 = 1e-6;

/// Checks everything that can be checked before the first computation.
pub(super) fn check(structure: &Structure, findings: &mut Findings) {
    let Some(given) = &structure.given else { return };
    let mesh = &structure.mesh;
    for (name, matrix) in [("stiffness", &given.stiffness), ("mass", &given.mass)] {
        definite(mesh, given, name, matrix, findings);
    }
    for row in 0..given.rows.len() {
        if given.stiffness.diagonal_entry(row) == 0.0 && given.mass.diagonal_entry(row) == 0.0 {
            findings.defects.push(Defect::Matrix {
                matrix: "stiffness and mass",
                row: describe(mesh, given, row),
                reason: "both diagonal entries are 0: nothing holds it and nothing moves it".into(),
                remedy: "leave the row out of both matrices, or take those of the same degrees of freedom",
            });
            break;
        }
    }
    let links = links(structure);
    if given.placed {
        let sizes = vec![f64::INFINITY; mesh.positions.len()];
        connections::check(mesh, &sizes, &links, findings);
    }
    let parts = parts(mesh, given);
    for link in &links {
        sides(mesh, given, &parts, link, findings);
    }
    for slip in &given.relative {
        relative(given, slip, findings);
    }
}

/// Largest sum of a relative displacement's coefficients along an axis, relative to the sum of their absolute values, that counts as zero.
/// Files with six digits leave 1e-6 for each of some hundred entries.
const UNMOVED: f64 = 1e-4;

/// Reports a relative displacement that is not zero when the whole structure moves along an axis, unless it is one to the ground: a sign is
/// wrong, or a side is missing.
fn relative(given: &Given, slip: &RelativeSlip, findings: &mut Findings) {
    if slip.to_ground {
        return;
    }
    for (axis, word) in ["x", "y", "z"].iter().enumerate() {
        let along = |&(row, c): &(usize, f64)| match given.rows.get(row) {
            Some(Row::Displacement { axis: own, .. }) if *own == axis => Some(c),
            _ => None,
        };
        let seen: f64 = slip.terms.iter().filter_map(along).sum();
        let all: f64 = slip.terms.iter().filter_map(along).map(f64::abs).sum();
        if seen.abs() > UNMOVED * all {
            let reason =
                format!("moving everything by 1 along {word} moves its relative displacement by {seen:e}");
            let remedy = "turn the sign of one side of the row, or say to_ground = true where it acts against the ground";
            findings.defects.push(Defect::Link { name: format!("joint `{}`", slip.name), reason, remedy });
            return;
        }
    }
}

/// A row, described in the numbering of the file.
fn describe(mesh: &Mesh, given: &Given, row: usize) -> String {
    const AXES: [&str; 3] = ["x", "y", "z"];
    match given.rows[row] {
        Row::Displacement { node, axis } => {
            format!("row {} (node {}, {})", row + 1, mesh.node_labels[node], AXES[axis])
        }
        Row::Rotation { node, axis } => {
            format!("row {} (node {}, rotation about {})", row + 1, mesh.node_labels[node], AXES[axis])
        }
        Row::Generalised => format!("row {} (a generalised coordinate)", row + 1),
    }
}

/// Checks conditions that every entry of a semi-definite matrix must meet; the first row that violates one is reported. Whether the whole
/// matrix is semi-definite is found by the factorisation.
fn definite(mesh: &Mesh, given: &Given, name: &'static str, matrix: &Symmetric, findings: &mut Findings) {
    let mut add = |row: usize, reason: String, remedy| {
        findings.defects.push(Defect::Matrix {
            matrix: name,
            row: describe(mesh, given, row),
            reason,
            remedy,
        });
    };
    let remedy = "check the sign and the units of the export, and that the file is of this model";
    if let Some(row) = (0..matrix.order()).find(|&row| matrix.diagonal_entry(row) < 0.0) {
        return add(row, format!("the diagonal entry is {:e}, below 0", matrix.diagonal_entry(row)), remedy);
    }
    let wrong = matrix.lower().find(|&(i, j, value)| {
        let most = (matrix.diagonal_entry(i) * matrix.diagonal_entry(j)).sqrt();
        i != j && value.abs() > (1.0 + ROUNDED) * most
    });
    if let Some((i, j, value)) = wrong {
        let most = (matrix.diagonal_entry(i) * matrix.diagonal_entry(j)).sqrt();
        let other = describe(mesh, given, j);
        let reason = format!(
            "the entry with {other} is {value:e}, larger than the root of the product of both diagonal entries, {most:e}: the \
             matrix is not semi-definite"
        );
        add(i, reason, "check that rows, columns and triangles are those of the file's own program");
    }
    if matrix.lower().all(|(_, _, value)| value == 0.0) {
        add(0, "all entries are 0".into(), "export the matrix of the assembled model");
    }
}

/// Part to which each node belongs, by the smallest index in it; a part is a set of nodes that the stiffness connects.
fn parts(mesh: &Mesh, given: &Given) -> Vec<usize> {
    let nodes = mesh.positions.len();
    // After the nodes there is one place for each row that belongs to no node.
    let mut parent: Vec<usize> = (0..nodes + given.rows.len()).collect();
    let place = |row: usize| match given.rows[row] {
        Row::Displacement { node, .. } | Row::Rotation { node, .. } => node,
        Row::Generalised => nodes + row,
    };
    let root = |parent: &mut Vec<usize>, mut at: usize| {
        while parent[at] != at {
            parent[at] = parent[parent[at]];
            at = parent[at];
        }
        at
    };
    for (i, j, value) in given.stiffness.lower() {
        if value != 0.0 {
            let (a, b) = (root(&mut parent, place(i)), root(&mut parent, place(j)));
            parent[a.max(b)] = a.min(b);
        }
    }
    (0..nodes).map(|node| root(&mut parent, node)).collect()
}

/// Checks both sides of a joint: whether they belong to one part, and whether positions are known where they are needed.
fn sides(mesh: &Mesh, given: &Given, parts: &[usize], link: &Link, findings: &mut Findings) {
    let (Some(&a), Some(&b)) = (link.face.first(), link.patch.first()) else { return };
    let name = link.name.clone();
    if a == b {
        let reason = format!("both sides begin with node {}", mesh.node_labels[a]);
        let remedy = "name nodes of two different places: a joint of a node with itself does nothing";
        findings.defects.push(Defect::Link { name, reason, remedy });
        return;
    }
    let whole = matches!(link.interface, Interface::Whole(_));
    let several = link.face.len() > 1 || link.patch.len() > 1;
    if !given.placed && (whole || several) {
        let reason = "it needs the positions of its nodes, and the matrices come without".to_string();
        let remedy = "add coordinates = \"FILE\" to [matrices], or name one node on each side and motion = \"directions\" or \"node-to-node\"";
        findings.defects.push(Defect::Link { name, reason, remedy });
        return;
    }
    if parts[a] == parts[b] {
        let (a, b) = (mesh.node_labels[a], mesh.node_labels[b]);
        let reason = format!(
            "nodes {a} and {b} on its two sides belong to one part: the stiffness connects them already, and the joint acts beside that"
        );
        findings.remarks.push(Remark::Link { name, reason });
    }
}
