//! Constraints, masses and sections that result from the kept keywords.

use super::super::super::constraint::{Constraint, PointMass, Rule, Section};
use super::super::super::error::{MeshError, MeshWarning};
use super::super::super::topology::Mesh;
use super::super::definition::Pending;
use super::lookup::Lookup;

/// Bytes of memory for constraints that each byte of the file allows; the limit is at least eight times as many bytes for each node, as
/// instances repeat nodes that the file writes once. Holding all nodes takes three bytes per byte of the file, tying all nodes in all
/// directions about twenty; a file that ties a set again and again would fill any memory. Beyond the limit the file is refused. Any factor
/// from twenty on does as well.
const PER_BYTE: usize = 40;
const PER_NODE: usize = 8 * PER_BYTE;

/// Results of the kept keywords.
#[derive(Debug)]
pub(in super::super) struct Outcome {
    pub(in super::super) constraints: Vec<Constraint>,
    pub(in super::super) masses: Vec<PointMass>,
    pub(in super::super) sections: Vec<Section>,
    pub(in super::super) warnings: Vec<MeshWarning>,
    /// Bytes that further constraints may still take.
    left: usize,
}

impl Outcome {
    pub(super) fn new(lookup: &Lookup, mesh: &Mesh) -> Self {
        let (bytes, nodes) = (lookup.source.bytes.len(), mesh.positions.len());
        let left = bytes.saturating_mul(PER_BYTE).max(nodes.saturating_mul(PER_NODE));
        let (constraints, masses) = (Vec::new(), Vec::new());
        Self { constraints, masses, sections: Vec::new(), warnings: Vec::new(), left }
    }

    /// Adds a constraint, if the limit of memory permits.
    pub(super) fn push(
        &mut self,
        lookup: &Lookup,
        text: &Pending,
        constraint: Constraint,
    ) -> Result<(), MeshError> {
        self.take(lookup, text, size(&constraint))?;
        self.constraints.push(constraint);
        Ok(())
    }

    /// Subtracts `bytes` from the remaining memory; an error if too little remains.
    pub(super) fn take(&mut self, lookup: &Lookup, text: &Pending, bytes: usize) -> Result<(), MeshError> {
        let Some(left) = self.left.checked_sub(bytes) else {
            let found = format!("*{}, with which sets are held or tied again and again,", text.keyword.name);
            let remedy = "write each node once, or fewer sets of many nodes";
            return Err(lookup.source.unsupported(text.keyword.place(lookup.source), found, remedy));
        };
        self.left = left;
        Ok(())
    }
}

/// Memory that a constraint takes, in bytes.
fn size(constraint: &Constraint) -> usize {
    let listed = match &constraint.rule {
        Rule::Equation(terms) => size_of_val(&terms[..]),
        Rule::Held(freedoms) => size_of_val(&freedoms[..]),
        Rule::Rigid { nodes, .. } => size_of_val(&nodes[..]),
        Rule::Mean { nodes, .. } => size_of_val(&nodes[..]),
        Rule::Interpolated { of, .. } => size_of_val(&of[..]),
    };
    size_of::<Constraint>() + constraint.name.len() + listed
}
