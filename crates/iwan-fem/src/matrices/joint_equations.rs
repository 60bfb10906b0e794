//! Equations of joints, ties and supports.

use faer::Mat;

use super::constraint_equations::{Rotations, constrain};
use super::elimination::{AXES, Equations, Source};
use super::unknowns::{Unknown, cross};
use crate::algebra::positive_inverse;
use crate::error::Error;
use crate::structure::{Given, Interface, Joint, Law, Patch, Row, Structure, Support};

/// A slip of an assembled structure and its unknown.
#[derive(Clone)]
pub struct SlipUnknown {
    /// Name: those of the joint and the direction, and, with node-to-node joints, the number of the node.
    pub name: String,
    /// Index of the joint in the structure; joints between rows of given matrices are counted after these.
    pub joint: usize,
    /// Index of the slip among the unknowns.
    pub unknown: usize,
    /// The law; a slip without a law slides freely.
    pub law: Option<Law>,
}

impl std::fmt::Debug for SlipUnknown {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SlipUnknown")
            .field("name", &self.name)
            .field("unknown", &self.unknown)
            .finish_non_exhaustive()
    }
}

/// The slips found while the equations are written. Until all equations are known, `unknown` counts the extra unknowns only.
pub(crate) type Slips = Vec<SlipUnknown>;

/// Writes the equations of all joints, then of all supports, then of the constraints of the mesh file.
pub(crate) fn connect<'a>(
    structure: &'a Structure,
    rotations: &Rotations,
) -> Result<(Equations<'a>, Slips), Error> {
    let further = structure.given.as_ref().map_or_else(|| rotations.meaning(), further);
    let (mut equations, mut slips) = (Equations::new(&structure.mesh, further), Slips::new());
    if let Some(given) = &structure.given {
        hold_unknown(&mut equations, given)?;
    }
    for (index, joint) in structure.joints.iter().enumerate() {
        let name = format!("joint `{}`", joint.name);
        let face = structure.nodes(&name, &joint.face)?;
        let patch = structure.nodes(&name, &joint.patch)?;
        if face.is_empty() || patch.is_empty() {
            return Err(refused(joint, "its face or patch has no nodes".into(), "fill the node sets"));
        }
        equations.owner(name);
        let mut writer = Writer { equations: &mut equations, slips: &mut slips, joint, index };
        match joint.interface {
            Interface::Whole(kind) => writer.whole(face, patch, kind)?,
            Interface::NodeToNode => writer.node_to_node(face, patch, false)?,
            Interface::Directions => writer.node_to_node(face, patch, true)?,
        }
    }
    for support in &structure.supports {
        fix(&mut equations, structure, support)?;
    }
    constrain(structure, rotations, &mut equations)?;
    Ok((equations, slips))
}

/// Rotations and generalised coordinates of given matrices, in the order of the matrices' rows.
fn further(given: &Given) -> Vec<Unknown> {
    let meaning = |(row, of): (usize, &Row)| match *of {
        Row::Displacement { .. } => None,
        Row::Rotation { node, axis } => Some(Unknown::Rotation { node, axis }),
        Row::Generalised => Some(Unknown::Generalised { row }),
    };
    given.rows.iter().enumerate().filter_map(meaning).collect()
}

/// Holds the displacements of nodes for which given matrices have neither a row nor a recovery.
fn hold_unknown(equations: &mut Equations<'_>, given: &Given) -> Result<(), Error> {
    equations.owner("the matrices, which have no row for it,".into());
    let mut known = vec![false; 3 * equations.mesh().positions.len()];
    for row in &given.rows {
        if let Row::Displacement { node, axis } = *row {
            known[3 * node + axis] = true;
        }
    }
    given.recovered.iter().for_each(|recovered| known[3 * recovered.node + recovered.axis] = true);
    for dof in (0..known.len()).filter(|&dof| !known[dof]) {
        equations.set(dof / 3, dof % 3, Vec::new())?;
    }
    Ok(())
}

fn fix(equations: &mut Equations<'_>, structure: &Structure, support: &Support) -> Result<(), Error> {
    let name = format!("support `{}`", support.name);
    let nodes = structure.nodes(&name, &support.nodes)?;
    equations.owner(name);
    for &node in nodes {
        for axis in (0..3).filter(|&axis| support.fixed[axis]) {
            equations.set(node, axis, Vec::new())?;
        }
    }
    Ok(())
}

fn refused(joint: &Joint, finding: String, remedy: &'static str) -> Error {
    Error::Connection { name: format!("joint `{}`", joint.name), finding, remedy }
}

/// Writes the equations of one joint.
struct Writer<'w, 'a> {
    equations: &'w mut Equations<'a>,
    slips: &'w mut Slips,
    joint: &'w Joint,
    index: usize,
}

/// Terms of the three displacements of a node.
type Rows = [Vec<(Source, f64)>; 3];

impl Writer<'_, '_> {
    fn position(&self, node: usize) -> [f64; 3] {
        self.equations.mesh().positions[node]
    }

    /// Unit vectors of the joint's slip directions.
    fn directions(&self) -> Result<Vec<[f64; 3]>, Error> {
        let unit = |d: [f64; 3]| {
            let length = d.iter().map(|x| x * x).sum::<f64>().sqrt();
            (length > 0.0 && length.is_finite()).then(|| d.map(|x| x / length))
        };
        let units: Option<Vec<_>> = self.joint.slips.iter().map(|slip| unit(slip.direction)).collect();
        // Cosines below 1e-9 are rounding of the given directions. With oblique slips, the motion that they have in common would count
        // twice.
        let orthogonal = |units: &Vec<[f64; 3]>| {
            let product = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            (0..units.len()).all(|i| (0..i).all(|j| product(&units[i], &units[j]).abs() < 1e-9))
        };
        units.filter(orthogonal).ok_or_else(|| {
            let given: Vec<_> = self.joint.slips.iter().map(|slip| slip.direction).collect();
            let remedy = "give at most three directions of length > 0 at right angles to each other";
            refused(self.joint, format!("slip directions {given:?} are not independent"), remedy)
        })
    }

    /// Adds the joint's slips at a place, and returns their terms in the displacements of the nodes that follow.
    fn add_slips(&mut self, at: [f64; 3], node: Option<usize>) -> Result<Rows, Error> {
        let mut rows = Rows::default();
        for (k, direction) in self.directions()?.into_iter().enumerate() {
            let source = self.equations.add_extra(Unknown::Slip { slip: self.slips.len() }, at);
            let axis = direction.iter().position(|d| d.abs() == 1.0);
            let which = axis.map_or_else(|| (k + 1).to_string(), |axis| AXES[axis].to_owned());
            let label = node.map(|node| format!(" node {}", self.equations.mesh().node_labels[node]));
            self.slips.push(SlipUnknown {
                name: format!("{} {which}{}", self.joint.name, label.unwrap_or_default()),
                joint: self.index,
                unknown: self.equations.extra.len() - 1,
                law: self.joint.slips[k].law.clone(),
            });
            for (row, d) in rows.iter_mut().zip(direction).filter(|(_, d)| *d != 0.0) {
                row.push((source, d));
            }
        }
        Ok(rows)
    }

    fn set(&mut self, node: usize, rows: Rows) -> Result<(), Error> {
        rows.into_iter().enumerate().try_for_each(|(axis, terms)| self.equations.set(node, axis, terms))
    }

    /// The whole face follows one rigid motion of the patch.
    fn whole(&mut self, face: &[usize], patch: &[usize], kind: Patch) -> Result<(), Error> {
        let frame = Frame::new(patch.iter().map(|&node| self.position(node)), self.joint)?;
        let motion: Vec<Rows> = match kind {
            Patch::Rigid => {
                let sources: [Source; 6] = std::array::from_fn(|component| {
                    let unknown = Unknown::Reference { joint: self.index, component };
                    self.equations.add_extra(unknown, frame.centre)
                });
                for &node in patch {
                    let rows = rigid_rows(&sources, frame.arm(self.position(node)));
                    self.set(node, rows)?;
                }
                face.iter().map(|&node| rigid_rows(&sources, frame.arm(self.position(node)))).collect()
            }
            Patch::Averaging => {
                let arms: Vec<_> = patch.iter().map(|&node| (node, frame.arm(self.position(node)))).collect();
                face.iter().map(|&node| frame.fitted_rows(&arms, frame.arm(self.position(node)))).collect()
            }
        };
        let slips = self.add_slips(frame.centre, None)?;
        for (&node, mut rows) in face.iter().zip(motion) {
            rows.iter_mut().zip(&slips).for_each(|(row, slip)| row.extend(slip));
            self.set(node, rows)?;
        }
        Ok(())
    }

    /// Each node of the face follows the node of the patch at the same place. With `free`, it does so only along the slips.
    fn node_to_node(&mut self, face: &[usize], patch: &[usize], free: bool) -> Result<(), Error> {
        let distance = |a: [f64; 3], b: [f64; 3]| (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt();
        let positions = &self.equations.mesh().positions;
        let size = distance(extreme(positions, f64::min), extreme(positions, f64::max));
        for &node in face {
            let at = self.position(node);
            let (other, gap) = patch
                .iter()
                .map(|&other| (other, distance(at, self.position(other))))
                .min_by(|a, b| a.1.total_cmp(&b.1))
                .expect("the patch has nodes");
            // The limit is relative to the diagonal of the mesh: files with seven digits round less, and matching meshes differ by no more.
            let alone = free && face.len() == 1 && patch.len() == 1;
            if gap > 1e-6 * size && !alone {
                return Err(Error::Node {
                    label: self.equations.mesh().node_labels[node],
                    finding: format!(
                        "joint `{}` finds no node of its patch within {:.3e}; the nearest is {gap:.3e} \
                        away",
                        self.joint.name,
                        1e-6 * size
                    ),
                    remedy: "let the meshes match at the interface, or use a whole-interface joint",
                });
            }
            let mut rows = self.add_slips(at, Some(node))?;
            for (axis, row) in rows.iter_mut().enumerate() {
                if free && row.is_empty() {
                    continue;
                }
                if free && row.iter().any(|term| term.1.abs() != 1.0) {
                    let finding = "it slips along no axis, but ties no other direction".into();
                    return Err(refused(
                        self.joint,
                        finding,
                        "give \"x\", \"y\" or \"z\" as directions of slip",
                    ));
                }
                row.push((Source::Displacement(3 * other + axis), 1.0));
                self.equations.set(node, axis, std::mem::take(row))?;
            }
        }
        Ok(())
    }
}

/// Smallest or largest coordinates of all positions.
fn extreme(positions: &[[f64; 3]], choose: impl Fn(f64, f64) -> f64) -> [f64; 3] {
    let start = positions.first().copied().unwrap_or_default();
    positions.iter().fold(start, |m, p| std::array::from_fn(|a| choose(m[a], p[a])))
}

/// Terms of the rigid motion u = u_ref + θ x r.
fn rigid_rows(sources: &[Source; 6], arm: [f64; 3]) -> Rows {
    std::array::from_fn(|axis| {
        let rotation = (0..3).map(|about| {
            let mut spin = [0.0; 3];
            spin[about] = 1.0;
            (sources[3 + about], cross(spin, arm)[axis])
        });
        let all = std::iter::once((sources[axis], 1.0)).chain(rotation);
        all.filter(|term| term.1 != 0.0).collect()
    })
}

/// Centre and inverse inertia of a patch's nodes, each with weight one.
struct Frame {
    centre: [f64; 3],
    inverse_inertia: [[f64; 3]; 3],
}

impl Frame {
    fn new(points: impl Iterator<Item = [f64; 3]> + Clone, joint: &Joint) -> Result<Self, Error> {
        let count = points.clone().count() as f64;
        let sum = points.clone().fold([0.0; 3], |s, p| std::array::from_fn(|a| s[a] + p[a]));
        let centre = sum.map(|s| s / count);
        let mut inertia = [[0.0; 3]; 3];
        for p in points {
            let r: [f64; 3] = std::array::from_fn(|a| p[a] - centre[a]);
            let square: f64 = r.iter().map(|x| x * x).sum();
            for a in 0..3 {
                for b in 0..3 {
                    inertia[a][b] += if a == b { square } else { 0.0 } - r[a] * r[b];
                }
            }
        }
        let inverse_inertia = inverse(&inertia).ok_or_else(|| {
            let finding = format!(
                "the {count} nodes of its patch lie on a line or in a point: no rotation follows from them"
            );
            refused(joint, finding, "give the patch at least three nodes that span a plane")
        })?;
        Ok(Self { centre, inverse_inertia })
    }

    fn arm(&self, at: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|a| at[a] - self.centre[a])
    }

    /// Rows of u = ū + θ x r with ū = Σ u_i/n and θ = J⁻¹ Σ r_i x u_i: the least-squares rigid motion of the patch.
    fn fitted_rows(&self, patch: &[(usize, [f64; 3])], arm: [f64; 3]) -> Rows {
        let mut rows = Rows::default();
        let share = 1.0 / patch.len() as f64;
        for &(node, r) in patch {
            for along in 0..3 {
                let mut unit = [0.0; 3];
                unit[along] = 1.0;
                let moment = cross(r, unit);
                let spin = self.inverse_inertia.map(|row| (0..3).map(|a| row[a] * moment[a]).sum::<f64>());
                let rotated = cross(spin, arm);
                for axis in 0..3 {
                    let coefficient = rotated[axis] + if axis == along { share } else { 0.0 };
                    if coefficient != 0.0 {
                        rows[axis].push((Source::Displacement(3 * node + along), coefficient));
                    }
                }
            }
        }
        rows
    }
}

/// Inverse of a symmetric positive definite 3 x 3 matrix; none when it is singular to rounding.
fn inverse(m: &[[f64; 3]; 3]) -> Option<[[f64; 3]; 3]> {
    let cofactor = |a: usize, b: usize| {
        let (p, q, r, s) = ((a + 1) % 3, (a + 2) % 3, (b + 1) % 3, (b + 2) % 3);
        m[p][r] * m[q][s] - m[p][s] * m[q][r]
    };
    let determinant: f64 = (0..3).map(|b| m[0][b] * cofactor(0, b)).sum();
    let size: f64 = (m[0][0] + m[1][1] + m[2][2]) / 3.0;
    // The limit is relative to the mean of the diagonal. Nodes that are no farther from a line than a hundred-thousandth of its length give
    // a smaller determinant.
    (determinant > 1e-9 * size.powi(3))
        .then(|| std::array::from_fn(|a| std::array::from_fn(|b| cofactor(b, a) / determinant)))
}

/// Inverse, row by row, of the symmetric positive definite matrix that couples the slips.
pub(crate) fn inverse_of(n: usize, entry: impl Fn(usize, usize) -> f64) -> Result<Vec<f64>, Error> {
    if n == 0 {
        return Ok(Vec::new());
    }
    let matrix = Mat::from_fn(n, n, |i, j| entry(i.max(j), i.min(j)));
    let inverse = positive_inverse(matrix).ok_or_else(|| Error::Analysis {
        analysis: "slips",
        finding: "the matrix that ties the slips together is not positive definite".into(),
        remedy: "check for joints that act on the same motion twice",
    })?;
    Ok((0..n * n).map(|k| inverse[(k / n, k % n)]).collect())
}
