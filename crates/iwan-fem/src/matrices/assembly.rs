//! Stiffness and mass of a structure in its unknowns.

use std::collections::BTreeMap;
use std::sync::OnceLock;

use super::constraint_equations::Rotations;
use super::elimination::Transformation;
use super::given_matrices;
use super::joint_equations::{SlipUnknown, connect};
use super::point_masses;
use super::row_equations;
use super::unknowns::{Unknown, triples};
use crate::algebra::{Analysis, NodalProduct, Site, Symmetric, add_scaled, largest, scale};
use crate::element::ElementMatrices;
use crate::error::{Error, check};
use crate::structure::Structure;

/// Matrices of a structure in the unknowns y, with x = T y: K_∞ without joints, M, and the slips on which the joints act.
#[derive(Debug, Clone)]
pub struct Assembled {
    structure: Structure,
    transformation: Transformation,
    stiffness: Symmetric,
    mass: Symmetric,
    damping: Option<Symmetric>,
    slips: Vec<SlipUnknown>,
    analysis: OnceLock<Analysis>,
    shift: OnceLock<f64>,
}

impl Structure {
    /// Assembles stiffness and mass.
    ///
    /// # Errors
    /// [`Error`] with the element, node, set or joint that does not fit, and a remedy.
    pub fn assemble(&self) -> Result<Assembled, Error> {
        let found = self.assemble_unheld()?;
        check_held(self, &found.transformation, &found.stiffness)?;
        Ok(found)
    }

    /// The same without the check that something holds each node.
    pub(super) fn assemble_unheld(&self) -> Result<Assembled, Error> {
        self.check_lumps()?;
        let rotations = Rotations::new(self);
        let (mut equations, mut slips) = connect(self, &rotations)?;
        if let Some(given) = &self.given {
            row_equations::connect(&mut equations, &mut slips, given, self.joints.len())?;
        }
        let extras = equations.extra.len();
        let transformation = equations.eliminate()?;
        if transformation.places.is_empty() {
            let finding =
                "no unknowns are left: supports and ties hold every displacement of every node".into();
            let remedy = "hold fewer nodes or directions";
            return Err(Error::Analysis { analysis: "assembly", finding, remedy });
        }
        let displacements = transformation.places.len() - extras;
        for slip in &mut slips {
            slip.unknown += displacements;
        }
        let (stiffness, mass, damping) = if let Some(given) = &self.given {
            let found = given_matrices::assemble(self.mesh.positions.len(), given, &transformation);
            (found.stiffness, found.mass, found.damping)
        } else {
            let (stiffness, mass) = assemble_elements(self, &transformation)?;
            (stiffness, mass, None)
        };
        let (stiffness, mass) = add_lumps(self, &transformation, stiffness, &mass)?;
        let (stiffness, mass) = point_masses::add(self, &rotations, &transformation, stiffness, mass)?;
        let structure = self.clone();
        let (analysis, shift) = (OnceLock::new(), OnceLock::new());
        Ok(Assembled { structure, transformation, stiffness, mass, damping, slips, analysis, shift })
    }
}

/// Largest force of a free motion, as a part of the largest stiffness entry times the motion, that counts as rounding; with a larger force
/// the motion is not free. Rigid motions of the free beam leave up to 2e-16. A spring to the ground counts from 1e-12 of the largest entry
/// on; below that the motion is integrated as if it were free.
const STRAINED: f64 = 1e-12;

/// Smallest length by which a motion must exceed those found already, relative to the largest possible; a smaller one is a combination of
/// these, such as a rotation where nodes have no positions. Lengths are roots of the mass form.
const ALONE: f64 = 1e-9;
/// The limit [`STRAINED`] for given matrices, which another program rounded to fewer digits when it wrote them: a text with 12 digits
/// leaves 1e-12 to 1e-11.
const STRAINED_AS_GIVEN: f64 = 1e-9;

/// Unknowns of an element, ascending, and the element's displacements in terms of them.
struct Local {
    unknowns: Vec<u32>,
    /// For each displacement of the element: position in `unknowns` and coefficient.
    rows: Vec<Vec<(usize, f64)>>,
    /// Whether each displacement is an unknown itself.
    plain: bool,
}

impl Local {
    fn new(nodes: &[usize], transformation: &Transformation) -> Self {
        let dofs = || nodes.iter().flat_map(|&node| (0..3).map(move |axis| 3 * node + axis));
        let mut unknowns: Vec<u32> =
            dofs().flat_map(|dof| transformation.row(dof).iter().map(|term| term.0)).collect();
        unknowns.sort_unstable();
        unknowns.dedup();
        let position = |j: u32| unknowns.binary_search(&j).expect("collected above");
        let rows: Vec<Vec<_>> = dofs()
            .map(|dof| transformation.row(dof).iter().map(|&(j, c)| (position(j), c)).collect())
            .collect();
        let plain = rows.iter().all(|row| row.len() == 1 && row[0].1 == 1.0) && unknowns.len() == rows.len();
        Self { unknowns, rows, plain }
    }

    /// Adds Tᵀ A T of one element; A couples the displacements for which `entry` returns a value.
    fn scatter(
        &self,
        into: &mut Symmetric,
        scratch: &mut Vec<f64>,
        entry: impl Fn(usize, usize) -> Option<f64>,
    ) {
        let m = self.unknowns.len();
        let at = |p: usize| self.unknowns[p] as usize;
        if self.plain {
            for (a, row) in self.rows.iter().enumerate() {
                for (b, other) in self.rows.iter().enumerate().filter(|(_, other)| other[0].0 <= row[0].0) {
                    if let Some(value) = entry(a, b) {
                        into.add(at(row[0].0), at(other[0].0), value);
                    }
                }
            }
            return;
        }
        scratch.clear();
        scratch.resize(m * m, 0.0);
        for (a, row) in self.rows.iter().enumerate() {
            for (b, other) in self.rows.iter().enumerate() {
                let Some(value) = entry(a, b) else { continue };
                for &(p, c) in row {
                    for &(q, d) in other {
                        scratch[p * m + q] += c * d * value;
                    }
                }
            }
        }
        for p in 0..m {
            (0..=p).for_each(|q| into.add(at(p), at(q), scratch[p * m + q]));
        }
    }
}

/// Stiffness and mass of all elements, on one pattern.
fn assemble_elements(
    structure: &Structure,
    transformation: &Transformation,
) -> Result<(Symmetric, Symmetric), Error> {
    let mesh = &structure.mesh;
    let locals: Vec<Local> = mesh.elements.iter().map(|e| Local::new(&e.nodes, transformation)).collect();
    let mut stiffness = pattern(transformation.places.len(), &locals);
    let mut mass = stiffness.clone();
    let materials = structure.element_materials()?;
    let options = (structure.formulation, structure.inertia);
    let (mut matrices, mut positions, mut scratch) = (ElementMatrices::default(), Vec::new(), Vec::new());
    for ((element, local), material) in mesh.elements.iter().zip(&locals).zip(&materials) {
        positions.clear();
        positions.extend(element.nodes.iter().map(|&node| mesh.positions[node]));
        matrices
            .compute(element.shape, options, material, &positions)
            .map_err(|no_volume| no_volume.in_element(element.label))?;
        let n = element.nodes.len();
        local.scatter(&mut stiffness, &mut scratch, |a, b| Some(matrices.stiffness[a * 3 * n + b]));
        local.scatter(&mut mass, &mut scratch, |a, b| {
            (a % 3 == b % 3).then(|| matrices.mass[a / 3 * n + b / 3]).filter(|&m| m != 0.0)
        });
    }
    Ok((stiffness, mass.without_zeros()))
}

/// The pattern of unknowns that occur together in an element.
fn pattern(order: usize, locals: &[Local]) -> Symmetric {
    let mut meets: Vec<Vec<u32>> = vec![Vec::new(); order];
    for (e, local) in locals.iter().enumerate() {
        local.unknowns.iter().for_each(|&j| meets[j as usize].push(e as u32));
    }
    let mut seen = vec![u32::MAX; order];
    Symmetric::with_pattern((0..order as u32).map(|j| {
        let mut rows = vec![j];
        seen[j as usize] = j;
        for &e in &meets[j as usize] {
            let unknowns = &locals[e as usize].unknowns;
            for &i in &unknowns[unknowns.partition_point(|&i| i <= j)..] {
                if seen[i as usize] != j {
                    seen[i as usize] = j;
                    rows.push(i);
                }
            }
        }
        rows.sort_unstable();
        rows
    }))
}

/// Adds the masses and springs of the lumps.
fn add_lumps(
    structure: &Structure,
    transformation: &Transformation,
    mut stiffness: Symmetric,
    mass: &Symmetric,
) -> Result<(Symmetric, Symmetric), Error> {
    let mut mass = mass.clone();
    for lump in &structure.lumps {
        let nodes = structure.nodes(&format!("`{}`", lump.name), &lump.nodes)?;
        let share = 1.0 / nodes.len().max(1) as f64;
        let (mut k, mut m) = (BTreeMap::new(), BTreeMap::new());
        for dof in nodes.iter().flat_map(|&node| 3 * node..3 * node + 3) {
            let row = transformation.row(dof);
            for &(i, c) in row {
                for &(j, d) in row.iter().filter(|term| term.0 <= i) {
                    *k.entry((j, i)).or_insert(0.0) += share * lump.stiffness[dof % 3] * c * d;
                    *m.entry((j, i)).or_insert(0.0) += share * lump.mass * c * d;
                }
            }
        }
        stiffness = stiffness.plus(1.0, &Symmetric::from_entries(stiffness.order(), &k));
        mass = mass.plus(1.0, &Symmetric::from_entries(mass.order(), &m));
    }
    Ok((stiffness, mass))
}

/// Reports a node or rotation that no element holds.
fn check_held(
    structure: &Structure,
    transformation: &Transformation,
    stiffness: &Symmetric,
) -> Result<(), Error> {
    for (j, place) in transformation.places.iter().enumerate() {
        let (node, finding, remedy) = match place.unknown {
            Unknown::Displacement { node, .. } => {
                (node, "no element holds it", "delete the node, or connect it")
            }
            Unknown::Rotation { node, .. } => {
                (node, "nothing holds its rotation", "let more nodes follow it, or hold the rotation")
            }
            _ => continue,
        };
        if structure.given.is_none() && stiffness.diagonal_entry(j) == 0.0 {
            let label = structure.mesh.node_labels[node];
            return Err(Error::Node { label, finding: finding.into(), remedy });
        }
    }
    Ok(())
}

impl Assembled {
    /// The structure that was assembled.
    #[must_use]
    pub fn structure(&self) -> &Structure {
        &self.structure
    }

    /// The transformation T in x = T y.
    pub(super) fn transformation(&self) -> &Transformation {
        &self.transformation
    }

    /// Number of unknowns.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        self.transformation.places.len()
    }

    /// Meaning of unknown `j`.
    ///
    /// # Panics
    /// When there is no such unknown.
    #[must_use]
    pub fn unknown(&self, j: usize) -> Unknown {
        self.transformation.places[j].unknown
    }

    /// Stiffness K_∞ with all joints slipping.
    #[must_use]
    pub fn slipping_stiffness(&self) -> &Symmetric {
        &self.stiffness
    }

    /// Stiffness K_0 with all joints stuck: K_∞ plus K_T of the joints on the diagonal.
    #[must_use]
    pub fn stuck_stiffness(&self) -> Symmetric {
        let mut joints = vec![0.0; self.unknowns()];
        for slip in &self.slips {
            joints[slip.unknown] = slip.law.as_ref().map_or(0.0, |law| law.initial_stiffness());
        }
        self.stiffness.plus(1.0, &Symmetric::diagonal(joints))
    }

    /// Mass.
    #[must_use]
    pub fn mass(&self) -> &Symmetric {
        &self.mass
    }

    /// Viscous damping, if it was given with the matrices.
    #[must_use]
    pub fn damping(&self) -> Option<&Symmetric> {
        self.damping.as_ref()
    }

    /// The slips.
    #[must_use]
    pub fn slips(&self) -> &[SlipUnknown] {
        &self.slips
    }

    /// Rigid motion of the whole structure: displacement along (0 to 2) or small rotation about (3 to 5) x, y or z.
    #[must_use]
    pub fn rigid_motion(&self, motion: usize) -> Vec<f64> {
        let mut all: Vec<f64> =
            self.transformation.places.iter().map(|place| place.rigid(motion, [0.0; 3])).collect();
        if let Some(given) = &self.structure.given {
            row_equations::move_slips(given, &self.structure.mesh, &self.slips, motion, &mut all);
        }
        all
    }

    /// Mass-normalised rigid motions that cause no strain: six for a free structure.
    pub(crate) fn free_motions(&self) -> Vec<Vec<f64>> {
        let mut motions: Vec<Vec<f64>> = Vec::new();
        for motion in 0..6 {
            let mut vector = self.rigid_motion(motion);
            let strain = largest(&self.stiffness.times(&vector));
            let strained = if self.structure.given.is_some() { STRAINED_AS_GIVEN } else { STRAINED };
            if largest(&vector) == 0.0 || strain > strained * self.stiffness.largest() * largest(&vector) {
                continue;
            }
            self.remove(&mut vector, &motions);
            let length = self.mass.form(&vector, &vector).sqrt();
            if length.is_nan() || length <= ALONE * largest(&vector) * self.mass.largest().sqrt() {
                continue;
            }
            scale(&mut vector, 1.0 / length);
            motions.push(vector);
        }
        motions
    }

    /// The shift, once it has been computed.
    pub(crate) fn known_shift(&self) -> &OnceLock<f64> {
        &self.shift
    }

    /// Subtracts from a vector its parts along mass-normalised motions.
    pub(crate) fn remove(&self, from: &mut [f64], motions: &[Vec<f64>]) {
        for motion in motions {
            let part = self.mass.form(motion, from);
            add_scaled(from, -part, motion);
        }
    }

    /// Displacements of all nodes from the unknowns `y`: x, y, z of the first node, then of the second, and so on.
    ///
    /// # Panics
    /// When `y` has fewer entries than there are unknowns.
    #[must_use]
    pub fn displacements(&self, y: &[f64]) -> Vec<f64> {
        self.transformation.apply(y, 3 * self.structure.mesh.positions.len())
    }

    /// Unknowns and coefficients that give the displacement of a node (index into the mesh) along x, y or z (0, 1, 2): one row of T.
    ///
    /// # Panics
    /// When there is no such node or axis.
    #[must_use]
    pub fn displacement_terms(&self, node: usize, axis: usize) -> &[(u32, f64)] {
        assert!(axis < 3 && node < self.structure.mesh.positions.len(), "a displacement of a node");
        self.transformation.row(3 * node + axis)
    }

    /// Forces on the unknowns that represent the total force `force` (x, y, z), distributed equally over the nodes of a set.
    ///
    /// # Errors
    /// [`Error::MissingSet`]; [`Error::Connection`] for an empty set; [`Error::OutOfRange`] for a force that is not finite.
    pub fn load(&self, set: &str, force: [f64; 3]) -> Result<Vec<f64>, Error> {
        let nodes = self.structure.nodes("a load", set)?;
        if nodes.is_empty() {
            let (finding, remedy) = ("the node set is empty".to_owned(), "name a set with nodes");
            return Err(Error::Connection { name: format!("load on `{set}`"), finding, remedy });
        }
        let mut out = vec![0.0; self.unknowns()];
        for (axis, component) in force.into_iter().enumerate() {
            check("load", component, true, "must be finite")?;
            let share = component / nodes.len() as f64;
            for &node in nodes {
                self.transformation.add_force(3 * node + axis, share, &mut out);
            }
        }
        Ok(out)
    }

    /// Coefficients that give the mean displacement of a set along `direction` from the unknowns: the displacement on which
    /// [`load`](Self::load) does work.
    ///
    /// # Errors
    /// The errors of [`load`](Self::load).
    pub fn gauge(&self, set: &str, direction: [f64; 3]) -> Result<Vec<f64>, Error> {
        self.load(set, direction)
    }

    /// K_∞ in the layout for products.
    pub(crate) fn nodal_stiffness(&self) -> NodalProduct {
        NodalProduct::new(&self.stiffness, triples(&self.transformation.places))
    }

    /// Approximate upper bound of the bytes that a search for `count` modes takes, from the order of elimination, and the bytes of one
    /// factor of the stiffness, which are part of it. Two factors are held at once: the one for the search, and the one for the count that
    /// shows whether a mode was missed.
    ///
    /// # Errors
    /// [`Error::Analysis`] if even the pattern of the factor does not fit into memory.
    pub fn search_bytes(&self, count: usize) -> Result<[u64; 2], Error> {
        /// Number of matrices as large as the stiffness that are held, with their copies, while one is factored: 9 to 11 in blocks and
        /// slender bars of 59,000 to 308,000 unknowns.
        const MATRICES: u64 = 11;
        /// Number of vectors, with their images, per mode: the search works with more columns than modes are requested.
        const VECTORS: u64 = 8;
        let number = size_of::<f64>() as u64;
        let factor = self.analysis()?.entries() as u64 * number;
        let matrix = self.stiffness.stored() as u64 * (number + size_of::<u32>() as u64);
        let vectors = VECTORS * count as u64 * self.unknowns() as u64 * number;
        Ok([2 * factor + MATRICES * matrix + vectors, factor])
    }

    /// Refuses a search for `count` modes if there is not enough memory.
    pub(crate) fn ask_for_search(&self, count: usize) -> Result<(), Error> {
        let remedy = "take a coarser mesh, fewer modes, or a machine with more memory";
        Ok(iwan_machine::memory::ask("a search for modes", self.search_bytes(count)?[0], remedy)?)
    }

    /// The order of elimination for all matrices of the structure, computed once.
    pub(crate) fn analysis(&self) -> Result<&Analysis, Error> {
        if let Some(analysis) = self.analysis.get() {
            return Ok(analysis);
        }
        let sites: Vec<Site> = self.transformation.places.iter().map(|place| place.site).collect();
        // The pattern is that of stiffness and mass together: a condensed mass couples unknowns that the stiffness does not.
        let analysis = Analysis::new(&self.stiffness.plus(1.0, &self.mass), &sites)?;
        Ok(self.analysis.get_or_init(|| analysis))
    }
}
