//! The check whether a mesh can be computed. Each defect is reported with the numbers of its elements and nodes and with a remedy.

mod finding;
mod link;
mod parts;
mod nodes;
mod connections;
mod quality;
mod given;

use std::collections::BTreeMap;

use super::description::Structure;
use crate::mesh::Mesh;
pub use finding::{Defect, Findings, Remark};
use link::{links, name};
pub use nodes::COINCIDENT;

impl Structure {
    /// Checks the mesh and all items that refer to it.
    ///
    /// Defects are: elements that are inverted, collapsed or use a node twice (the Jacobian determinant at the integration points and at
    /// the corners must be positive); elements with the same nodes; nodes without an element; nodes at the same place within one part;
    /// parts that nothing connects with the rest; sets that are missing or empty; and ties and joints that cannot work. Two nodes count as
    /// at the same place when they are closer than [`COINCIDENT`] of the shortest edge at either. Nodes of two *different* parts at the
    /// same place are only a remark, and none if a tie or joint connects them: contact faces are meshed so on purpose.
    ///
    /// The time grows with the size of the mesh; the search for the nearest pair of nodes between the two sides of a joint takes time
    /// proportional to the product of their sizes.
    #[must_use]
    pub fn check(&self) -> Findings {
        let (mesh, mut findings) = (&self.mesh, Findings::default());
        sets(self, &mut findings);
        if self.given.is_some() {
            given::check(self, &mut findings);
            return findings;
        }
        quality::check(mesh, &mut findings);
        let links = links(self);
        let parts = parts::Parts::new(mesh);
        let sizes = nodes::sizes(mesh);
        let pairs = nodes::coincident(mesh, &sizes);
        nodes::orphans(self, &parts, &mut findings);
        let connections = (&links[..], &self.constraints[..]);
        nodes::report(mesh, &parts, &pairs, connections, &mut findings);
        parts::unconnected(mesh, &parts, &pairs, connections, &mut findings);
        connections::check(mesh, &sizes, &links, &mut findings);
        findings
    }
}

/// Reports sets that are referred to but do not exist or are empty.
fn sets(structure: &Structure, findings: &mut Findings) {
    let Mesh { node_sets, element_sets, .. } = &structure.mesh;
    let mut look_up = |user: String, kind, name: &str, sets: &BTreeMap<String, Vec<usize>>| {
        let defect = match sets.get(name) {
            Some(set) if !set.is_empty() => return,
            Some(_) => Defect::EmptySet { user, kind, name: name.into() },
            None => {
                Defect::MissingSet { user, kind, name: name.into(), known: sets.keys().cloned().collect() }
            }
        };
        findings.defects.push(defect);
    };
    for joint in &structure.joints {
        for set in [&joint.face, &joint.patch] {
            look_up(name(joint), "node", set, node_sets);
        }
    }
    for support in &structure.supports {
        look_up(format!("support `{}`", support.name), "node", &support.nodes, node_sets);
    }
    for lump in &structure.lumps {
        look_up(format!("lump `{}`", lump.name), "node", &lump.nodes, node_sets);
    }
    for (set, _) in &structure.materials {
        look_up("a material".into(), "element", set, element_sets);
    }
}
