//! Equations from the constraints of a mesh file: rigid groups, weighted means, points of faces, linear equations.
//!
//! Nodes of solid elements have no rotations. A node that others follow rigidly, or whose rotations follow a mean, gets three rotations of
//! its own.

use std::collections::{BTreeMap, BTreeSet};

use faer::Mat;

use super::elimination::{Equations, Source};
use super::unknowns::{Unknown, cross};
use crate::algebra::positive_inverse;
use crate::error::Error;
use crate::mesh::{Constraint, Directions, Freedom, Mesh, Rule, Weighted};
use crate::structure::Structure;

/// First degree of freedom of the rotations, for each node that has rotations.
#[derive(Debug, Clone, Default)]
pub(crate) struct Rotations(BTreeMap<usize, usize>);

impl Rotations {
    /// Rotations of reference nodes, numbered after the displacements of all nodes.
    pub(crate) fn new(structure: &Structure) -> Self {
        let reference = |constraint: &Constraint| match &constraint.rule {
            Rule::Rigid { reference, .. } => Some(*reference),
            Rule::Mean { reference, components, .. } => components[3..].contains(&true).then_some(*reference),
            _ => None,
        };
        let nodes: BTreeSet<usize> = structure.constraints.iter().filter_map(reference).collect();
        let first = 3 * structure.mesh.positions.len();
        Self(nodes.into_iter().enumerate().map(|(index, node)| (node, first + 3 * index)).collect())
    }

    /// Meaning of the degrees of freedom after the displacements.
    pub(crate) fn meaning(&self) -> Vec<Unknown> {
        self.0.keys().flat_map(|&node| (0..3).map(move |axis| Unknown::Rotation { node, axis })).collect()
    }

    /// Degree of freedom of a component of a node; none for a rotation of a node that has no rotations.
    pub(crate) fn dof(&self, Freedom { node, component }: Freedom) -> Option<usize> {
        match component.checked_sub(3) {
            None => Some(3 * node + component),
            Some(about) => self.0.get(&node).map(|first| first + about),
        }
    }
}

/// Writes the equations of all constraints in this order: held freedoms, rigid groups, points on faces, means, and linear equations. Each
/// is expressed in terms of those before it.
pub(crate) fn constrain(
    structure: &Structure,
    rotations: &Rotations,
    equations: &mut Equations<'_>,
) -> Result<(), Error> {
    let rank = |constraint: &&Constraint| match constraint.rule {
        Rule::Held(_) => 0,
        Rule::Rigid { .. } => 1,
        Rule::Interpolated { .. } => 2,
        Rule::Mean { .. } => 3,
        Rule::Equation(_) => 4,
    };
    let mut ordered: Vec<&Constraint> = structure.constraints.iter().collect();
    ordered.sort_by_key(rank);
    for constraint in &ordered {
        equations.owner(constraint.name.clone());
        Writer { equations, rotations, constraint }.write()?;
    }
    turn_about_lines(structure, rotations, equations)
}

/// Writes one constraint.
struct Writer<'w, 'a> {
    equations: &'w mut Equations<'a>,
    rotations: &'w Rotations,
    constraint: &'w Constraint,
}

impl Writer<'_, '_> {
    fn write(&mut self) -> Result<(), Error> {
        match &self.constraint.rule {
            Rule::Equation(terms) => self.linear(terms),
            Rule::Held(freedoms) => freedoms.iter().try_for_each(|&freedom| {
                let Some(dof) = self.rotations.dof(freedom) else { return Ok(()) };
                self.equations.equation(&[(Source::Displacement(dof), 1.0)], &[])
            }),
            Rule::Rigid { reference, nodes, components, directions } => nodes
                .iter()
                .filter(|node| *node != reference)
                .try_for_each(|&node| self.rigid(*reference, node, *components, directions)),
            Rule::Mean { reference, components, nodes, directions } => {
                self.mean(*reference, *components, nodes, directions)
            }
            Rule::Interpolated { node, of } => (0..3).try_for_each(|axis| {
                let own = 3 * node + axis;
                let others = of.iter().map(|(other, value)| (Source::Displacement(3 * other + axis), -value));
                let terms: Vec<_> = std::iter::once((Source::Displacement(own), 1.0)).chain(others).collect();
                self.equations.equation(&terms, &[own])
            }),
        }
    }

    fn refused(&self, finding: String, remedy: &'static str) -> Error {
        Error::Connection { name: self.constraint.name.clone(), finding, remedy }
    }

    fn linear(&mut self, terms: &[(Freedom, f64)]) -> Result<(), Error> {
        let mut sources = Vec::new();
        for &(freedom, coefficient) in terms {
            let dof = self.rotations.dof(freedom).ok_or_else(|| {
                let label = self.equations.mesh().node_labels[freedom.node];
                let finding = format!("it has a rotation of node {label}, which has none: solid elements do not turn their nodes");
                self.refused(finding, "refer to the reference node of a rigid body or coupling, or drop the term")
            })?;
            sources.push((Source::Displacement(dof), coefficient));
        }
        let first = sources.first().map(|(source, _)| match source {
            Source::Displacement(dof) | Source::Extra(dof) => *dof,
        });
        self.equations.equation(&sources, first.as_slice())
    }

    /// Terms of the displacement along a direction (`component` 0 to 2), or of the rotation about it (3 to 5), that the rigid motion of a
    /// reference node causes at the end of an arm.
    fn motion(
        &self,
        reference: usize,
        arm: [f64; 3],
        component: usize,
        direction: [f64; 3],
    ) -> Vec<(Source, f64)> {
        let rotation = |about| self.rotations.dof(Freedom { node: reference, component: 3 + about });
        let mut terms = Vec::new();
        // d·(θ x r) = θ·(r x d).
        let spin = if component < 3 { cross(arm, direction) } else { direction };
        if component < 3 {
            terms.extend((0..3).map(|a| (Source::Displacement(3 * reference + a), direction[a])));
        }
        terms.extend((0..3).filter_map(|about| Some((Source::Displacement(rotation(about)?), spin[about]))));
        terms
    }

    fn rigid(
        &mut self,
        reference: usize,
        node: usize,
        components: [bool; 6],
        directions: &Directions,
    ) -> Result<(), Error> {
        let arm = difference(self.equations.mesh(), node, reference);
        for component in (0..6).filter(|c| components[*c]) {
            let direction = directions[component % 3];
            let own = |a: usize| self.rotations.dof(Freedom { node, component: 3 * (component / 3) + a });
            if own(0).is_none() {
                continue;
            }
            let lead = self.motion(reference, arm, component, direction);
            let follow = (0..3).filter_map(|a| Some((Source::Displacement(own(a)?), direction[a])));
            let terms: Vec<_> = follow.chain(lead.into_iter().map(|(source, c)| (source, -c))).collect();
            // The node's component for which the direction has the largest entry; in global axes this is the direction itself.
            let along = largest(direction);
            let preferred: Vec<usize> = own(along).into_iter().collect();
            let terms: Vec<_> = terms.into_iter().filter(|(_, c)| *c != 0.0).collect();
            self.equations.equation(&terms, &preferred)?;
        }
        Ok(())
    }

    /// Writes the mean: the least-squares motion q = A⁻¹ Σ w Sᵀ u at the nodes' weighted centre, with A = Σ w Sᵀ S and S u = u + θ x r in
    /// the components that count. The motion of the reference node follows rigidly from that at the centre (MSC Nastran Quick Reference
    /// Guide, RBE3).
    fn mean(
        &mut self,
        reference: usize,
        components: [bool; 6],
        nodes: &[Weighted],
        directions: &Directions,
    ) -> Result<(), Error> {
        let positions = &self.equations.mesh().positions;
        let total: f64 = nodes.iter().map(|n| n.weight).sum();
        let centre: [f64; 3] = std::array::from_fn(|a| {
            nodes.iter().map(|n| n.weight * positions[n.node][a]).sum::<f64>() / total
        });
        let arm = |node: usize| -> [f64; 3] { std::array::from_fn(|a| positions[node][a] - centre[a]) };
        let size = nodes.iter().map(|n| norm(arm(n.node))).fold(0.0, f64::max);
        // Rotations are multiplied by the size of the set, so that all six unknowns are lengths.
        let row = |node: usize, direction: [f64; 3]| -> [f64; 6] {
            let spin = cross(arm(node), direction).map(|x| x / size);
            std::array::from_fn(|k| if k < 3 { direction[k] } else { spin[k - 3] })
        };
        let each = || nodes.iter().flat_map(|n| (0..3).filter(|c| n.components[*c]).map(move |c| (n, c)));
        let mut matrix = Mat::<f64>::zeros(6, 6);
        for (n, c) in each() {
            let s = row(n.node, directions[c]);
            for i in 0..6 {
                for j in 0..6 {
                    matrix[(i, j)] += n.weight / total * s[i] * s[j];
                }
            }
        }
        // The smallest eigenvalue of the six is the square of the ratio of the set's width to its length. Below a ratio of a millionth no
        // rotation follows.
        let inverse = Some(matrix).filter(|m| size > 0.0 && least(m) > 1e-12).and_then(positive_inverse);
        let inverse = inverse.ok_or_else(|| {
            let finding = format!(
                "its {} nodes are on one line or fewer than three: no rotation follows from them",
                nodes.len()
            );
            self.refused(
                finding,
                "give it at least three nodes that span a plane, in all three displacements",
            )
        })?;
        let to_reference: [f64; 3] = std::array::from_fn(|a| positions[reference][a] - centre[a]);
        let rows: Vec<(Source, [f64; 6])> = each()
            .flat_map(|(n, c)| {
                let s = row(n.node, directions[c]);
                let q: [f64; 6] = std::array::from_fn(|i| {
                    n.weight / total * (0..6).map(|j| inverse[(i, j)] * s[j]).sum::<f64>()
                });
                (0..3).map(move |a| (Source::Displacement(3 * n.node + a), q.map(|x| x * directions[c][a])))
            })
            .collect();
        for component in (0..6).filter(|c| components[*c]) {
            let direction = directions[component % 3];
            let spin = if component < 3 { cross(to_reference, direction) } else { direction };
            let weight: [f64; 6] = std::array::from_fn(|k| match (k, component < 3) {
                (0..3, true) => direction[k],
                (0..3, false) => 0.0,
                _ => spin[k - 3] / size,
            });
            let own = |a: usize| {
                self.rotations.dof(Freedom { node: reference, component: 3 * (component / 3) + a })
            };
            let mut terms: Vec<(Source, f64)> =
                (0..3).filter_map(|a| Some((Source::Displacement(own(a)?), direction[a]))).collect();
            terms.extend(
                rows.iter().map(|(source, q)| (*source, -(0..6).map(|k| weight[k] * q[k]).sum::<f64>())),
            );
            terms.retain(|(_, c)| *c != 0.0);
            let preferred: Vec<usize> = own(largest(direction)).into_iter().collect();
            self.equations.equation(&terms, &preferred)?;
        }
        Ok(())
    }
}

/// Holds rotations that have no effect: if all nodes that follow a reference node lie on one line with it, or at its place, the rotation
/// about that line is held, unless another constraint or an inertia involves it.
fn turn_about_lines(
    structure: &Structure,
    rotations: &Rotations,
    equations: &mut Equations<'_>,
) -> Result<(), Error> {
    let mut groups: BTreeMap<usize, Vec<[f64; 3]>> = BTreeMap::new();
    for constraint in &structure.constraints {
        if let Rule::Rigid { reference, nodes, .. } = &constraint.rule {
            let arms = nodes.iter().map(|node| difference(equations.mesh(), *node, *reference));
            groups.entry(*reference).or_default().extend(arms);
        }
    }
    let times = |node: usize| {
        let rigid = |c: &&Constraint| !matches!(&c.rule, Rule::Rigid { reference, .. } if *reference == node);
        structure.constraints.iter().filter(rigid).any(|c| c.nodes().contains(&node))
            || structure
                .masses
                .iter()
                .any(|mass| mass.node == node && mass.inertia.as_flattened().iter().any(|i| *i != 0.0))
    };
    for (node, arms) in groups {
        let Some(lines) = free_lines(&arms) else { continue };
        if times(node) {
            continue;
        }
        equations.owner(format!("the rigid group of node {}", equations.mesh().node_labels[node]));
        for direction in lines {
            let term = |about: usize| {
                Some((
                    Source::Displacement(rotations.dof(Freedom { node, component: 3 + about })?),
                    direction[about],
                ))
            };
            let terms: Vec<_> = (0..3).filter_map(term).filter(|(_, c)| *c != 0.0).collect();
            equations.equation(&terms, &[])?;
        }
    }
    Ok(())
}

/// Directions about which a group with these arms can turn without moving anything: the line of the arms, or all three axes if the arms
/// have no length; none for a group that spans a plane.
fn free_lines(arms: &[[f64; 3]]) -> Option<Vec<[f64; 3]>> {
    let longest = arms.iter().copied().max_by(|a, b| norm(*a).total_cmp(&norm(*b)))?;
    if norm(longest) == 0.0 {
        return Some(crate::mesh::GLOBAL.to_vec());
    }
    let along = longest.map(|x| x / norm(longest));
    // The limit is a thousandth of the length, as for the patches of joints; files with six digits round far less.
    let on_line = arms.iter().all(|arm| norm(cross(*arm, along)) <= 1e-3 * norm(longest));
    on_line.then(|| vec![along])
}

fn difference(mesh: &Mesh, node: usize, from: usize) -> [f64; 3] {
    std::array::from_fn(|a| mesh.positions[node][a] - mesh.positions[from][a])
}

fn norm(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Index of the largest component.
fn largest(v: [f64; 3]) -> usize {
    (1..3).fold(0, |best, a| if v[a].abs() > v[best].abs() { a } else { best })
}

/// Smallest eigenvalue of a symmetric matrix; -1 if it cannot be computed.
fn least(matrix: &Mat<f64>) -> f64 {
    matrix.self_adjoint_eigenvalues(faer::Side::Lower).map_or(-1.0, |values| values[0])
}
