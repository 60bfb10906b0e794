//! Elimination of all dependent displacements: x = T y, with the slips among the unknowns y.
//!
//! A joint's stiffness is then an entry on the diagonal and each Iwan element acts on one scalar unknown; there are
//! neither penalties nor multipliers, and the matrices stay symmetric and positive (semi-)definite.

use std::collections::BTreeMap;

use super::unknowns::{Place, Unknown};
use crate::algebra::Site;
use crate::error::Error;
use crate::mesh::Mesh;

/// Size of a coefficient, relative to the largest given one, up to which it counts as rounding: terms cancel in a constraint that already
/// holds.
const CANCELLED: f64 = 1e-12;
/// Size of a coefficient, relative to the largest, below which the equation is not divided by it even if the user named its displacement
/// first: the division would lose six digits.
const SMALL: f64 = 1e-6;

/// What a displacement follows: another displacement, or an unknown that is not a displacement of a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Source {
    /// Degree of freedom 3 node + axis, or one of the further degrees of freedom after these.
    Displacement(usize),
    /// Index into [`Equations::extra`].
    Extra(usize),
}

/// Linear equations for the displacements that depend on others.
#[derive(Debug)]
pub(crate) struct Equations<'a> {
    mesh: &'a Mesh,
    /// Meaning of the degrees of freedom after the displacements of all nodes: rotations and generalised coordinates.
    further: Vec<Unknown>,
    /// Terms of each dependent displacement; none for independent ones.
    rows: Vec<Option<Vec<(Source, f64)>>>,
    /// The item that made the displacement dependent: an index into `names`.
    owners: Vec<usize>,
    names: Vec<String>,
    /// Unknowns that are not displacements of nodes, with their positions.
    pub(crate) extra: Vec<(Unknown, [f64; 3])>,
}

impl<'a> Equations<'a> {
    pub(crate) fn new(mesh: &'a Mesh, further: Vec<Unknown>) -> Self {
        let n = 3 * mesh.positions.len() + further.len();
        Self { mesh, further, rows: vec![None; n], owners: vec![0; n], names: Vec::new(), extra: Vec::new() }
    }

    pub(crate) fn mesh(&self) -> &'a Mesh {
        self.mesh
    }

    /// Sets the name of the item to which the equations added from now on belong.
    pub(crate) fn owner(&mut self, name: String) {
        self.names.push(name);
    }

    /// Adds an unknown that is not a displacement of a node.
    pub(crate) fn add_extra(&mut self, unknown: Unknown, position: [f64; 3]) -> Source {
        self.extra.push((unknown, position));
        Source::Extra(self.extra.len() - 1)
    }

    /// Makes the displacement of a node along an axis a sum of terms; without terms it is fixed.
    pub(crate) fn set(&mut self, node: usize, axis: usize, terms: Vec<(Source, f64)>) -> Result<(), Error> {
        let dof = 3 * node + axis;
        let owner = self.names.len() - 1;
        if self.rows[dof].is_some() {
            let (first, second) = (&self.names[self.owners[dof]], &self.names[owner]);
            return Err(Error::Node {
                label: self.mesh.node_labels[node],
                finding: format!("its motion along {} is given by {first} and again by {second}", AXES[axis]),
                remedy: "take the node out of one of the two node sets",
            });
        }
        self.rows[dof] = Some(terms);
        self.owners[dof] = owner;
        Ok(())
    }

    /// Makes Σ c x = 0 hold. Displacements that are already eliminated are replaced by their terms; then one of the remaining displacements
    /// is eliminated. It is the first in `preferred` that occurs with a coefficient that is not small, otherwise the one with the largest
    /// coefficient. Nothing is done if the equation already holds.
    pub(crate) fn equation(&mut self, terms: &[(Source, f64)], preferred: &[usize]) -> Result<(), Error> {
        let mut sum: BTreeMap<Source, f64> = BTreeMap::new();
        for &(source, coefficient) in terms {
            self.expand(source, coefficient, 0, &mut sum)?;
        }
        let given = terms.iter().fold(0.0_f64, |m, term| m.max(term.1.abs()));
        sum.retain(|_, c| c.abs() > CANCELLED * given);
        if sum.is_empty() {
            return Ok(());
        }
        let largest = sum.values().fold(0.0_f64, |m, c| m.max(c.abs()));
        let chosen = preferred.iter().map(|dof| Source::Displacement(*dof));
        let mut chosen = chosen.filter(|s| sum.get(s).is_some_and(|c| c.abs() > SMALL * largest));
        let best = || {
            let dofs = sum.iter().filter(|(source, _)| matches!(source, Source::Displacement(_)));
            dofs.fold(None, |best: Option<(Source, f64)>, (source, c)| match best {
                Some((_, most)) if most >= c.abs() => best,
                _ => Some((*source, c.abs())),
            })
        };
        let Some(Source::Displacement(dof)) = chosen.next().or_else(|| best().map(|(source, _)| source))
        else {
            return Err(Error::Connection {
                name: self.names.last().cloned().unwrap_or_default(),
                finding: "it leaves nothing free but slips of joints".into(),
                remedy: "take its nodes out of the joints' faces, or drop it",
            });
        };
        let pivot = sum.remove(&Source::Displacement(dof)).expect("chosen above");
        self.rows[dof] = Some(sum.into_iter().map(|(source, c)| (source, -c / pivot)).collect());
        self.owners[dof] = self.names.len() - 1;
        Ok(())
    }

    /// Adds a term to a sum; a dependent displacement is replaced by its terms.
    fn expand(
        &self,
        source: Source,
        coefficient: f64,
        depth: usize,
        sum: &mut BTreeMap<Source, f64>,
    ) -> Result<(), Error> {
        let row = match source {
            Source::Displacement(dof) => self.rows[dof].as_ref().map(|row| (dof, row)),
            Source::Extra(_) => None,
        };
        let Some((dof, row)) = row else {
            *sum.entry(source).or_insert(0.0) += coefficient;
            return Ok(());
        };
        if depth > LONGEST_CHAIN {
            return Err(self.circle(dof));
        }
        row.iter().try_for_each(|&(other, c)| self.expand(other, c * coefficient, depth + 1, sum))
    }

    /// Number of the node to which a displacement or rotation belongs, for messages.
    fn label(&self, dof: usize) -> u64 {
        let node = match dof.checked_sub(3 * self.mesh.positions.len()).map(|at| self.further[at]) {
            None => dof / 3,
            Some(Unknown::Rotation { node, .. }) => node,
            Some(_) => return 0,
        };
        self.mesh.node_labels[node]
    }

    fn circle(&self, dof: usize) -> Error {
        Error::Node {
            label: self.label(dof),
            finding: format!("{} makes its motion depend on itself", self.names[self.owners[dof]]),
            remedy: "the face and the patch of a joint must not share nodes, nor follow each other in a circle",
        }
    }

    /// Eliminates all dependent displacements.
    pub(crate) fn eliminate(self) -> Result<Transformation, Error> {
        let free: Vec<usize> = (0..self.rows.len()).filter(|&dof| self.rows[dof].is_none()).collect();
        let mut numbers = vec![0_u32; self.rows.len()];
        free.iter().enumerate().for_each(|(number, &dof)| numbers[dof] = number as u32);
        let nodes = self.mesh.positions.len();
        let group = |unknown: Unknown| match unknown {
            Unknown::Displacement { node, .. } | Unknown::Rotation { node, .. } => node,
            Unknown::Generalised { row } => nodes + 3 * row,
            Unknown::Reference { joint, .. } => nodes + 3 * joint + 1,
            Unknown::Slip { slip } => nodes + 3 * slip + 2,
        };
        let middle = middle(self.mesh);
        let displacement = |&dof: &usize| {
            let unknown = match dof.checked_sub(3 * nodes) {
                None => Unknown::Displacement { node: dof / 3, axis: dof % 3 },
                Some(at) => self.further[at],
            };
            let position = match unknown {
                Unknown::Displacement { node, .. } | Unknown::Rotation { node, .. } => {
                    self.mesh.positions[node]
                }
                _ => middle,
            };
            Place { unknown, site: Site { position, group: group(unknown) as u32 } }
        };
        let extra = |&(unknown, position): &(Unknown, [f64; 3])| Place {
            unknown,
            site: Site { position, group: group(unknown) as u32 },
        };
        let places: Vec<Place> = free.iter().map(displacement).chain(self.extra.iter().map(extra)).collect();
        let mut resolver = Resolver {
            equations: &self,
            numbers,
            extras_from: free.len() as u32,
            done: Vec::new(),
            depth: 0,
        };
        resolver.done.resize(self.rows.len(), None);
        let (mut starts, mut terms) = (vec![0], Vec::new());
        for dof in 0..self.rows.len() {
            terms.extend(resolver.resolve(dof)?);
            starts.push(terms.len() as u32);
        }
        Ok(Transformation { starts, terms, places })
    }
}

/// Mean position of all nodes.
fn middle(mesh: &Mesh) -> [f64; 3] {
    let n = mesh.positions.len().max(1) as f64;
    std::array::from_fn(|a| mesh.positions.iter().map(|p| p[a]).sum::<f64>() / n)
}

/// Names of the axes, for messages.
pub(crate) const AXES: [&str; 3] = ["x", "y", "z"];

/// Expands chains of equations.
struct Resolver<'a> {
    equations: &'a Equations<'a>,
    numbers: Vec<u32>,
    extras_from: u32,
    done: Vec<Option<Vec<(u32, f64)>>>,
    depth: usize,
}

/// Largest length of a chain of dependence; a longer one counts as a circle and is refused. A face that follows a patch whose nodes follow
/// another patch, and so on, makes a chain of as many links as parts are bolted in a row.
const LONGEST_CHAIN: usize = 64;

impl Resolver<'_> {
    fn resolve(&mut self, dof: usize) -> Result<Vec<(u32, f64)>, Error> {
        let Some(row) = &self.equations.rows[dof] else {
            return Ok(vec![(self.numbers[dof], 1.0)]);
        };
        if let Some(known) = &self.done[dof] {
            return Ok(known.clone());
        }
        if self.depth > LONGEST_CHAIN {
            return Err(self.equations.circle(dof));
        }
        self.depth += 1;
        let mut terms: Vec<(u32, f64)> = Vec::new();
        for &(source, coefficient) in row {
            match source {
                Source::Extra(index) => terms.push((self.extras_from + index as u32, coefficient)),
                Source::Displacement(other) => {
                    terms.extend(self.resolve(other)?.iter().map(|&(number, c)| (number, c * coefficient)));
                }
            }
        }
        self.depth -= 1;
        terms.sort_by_key(|term| term.0);
        terms.dedup_by(|next, kept| {
            let same = next.0 == kept.0;
            if same {
                kept.1 += next.1;
            }
            same
        });
        terms.retain(|term| term.1 != 0.0);
        self.done[dof] = Some(terms.clone());
        Ok(terms)
    }
}

/// x = T y: displacements of all nodes from the unknowns.
#[derive(Debug, Clone)]
pub(crate) struct Transformation {
    starts: Vec<u32>,
    terms: Vec<(u32, f64)>,
    pub(crate) places: Vec<Place>,
}

impl Transformation {
    /// Unknowns and coefficients that give the displacement 3 node + axis.
    pub(crate) fn row(&self, dof: usize) -> &[(u32, f64)] {
        &self.terms[self.starts[dof] as usize..self.starts[dof + 1] as usize]
    }

    /// The first `count` entries of x = T y.
    pub(crate) fn apply(&self, y: &[f64], count: usize) -> Vec<f64> {
        let value = |dof| self.row(dof).iter().map(|&(j, c)| c * y[j as usize]).sum();
        (0..count).map(value).collect()
    }

    /// Adds to a vector of forces on the unknowns Tᵀ of a force on one displacement.
    pub(crate) fn add_force(&self, dof: usize, force: f64, out: &mut [f64]) {
        self.row(dof).iter().for_each(|&(j, c)| out[j as usize] += c * force);
    }
}
