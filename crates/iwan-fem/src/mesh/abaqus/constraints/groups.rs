//! Readers of `*COUPLING`, `*RIGID BODY` and `*MASS`.

use std::collections::BTreeMap;

use super::super::super::constraint::{Constraint, GLOBAL, PointMass, Rule, Weighted};
use super::super::super::error::MeshError;
use super::super::super::topology::Mesh;
use super::super::definition::Pending;
use super::super::surfaces::Surface;
use super::lookup::Lookup;
use super::outcome::Outcome;

/// Reads `*COUPLING` with the `*KINEMATIC` or `*DISTRIBUTING` that follows.
pub(super) fn coupling(
    lookup: &Lookup,
    mesh: &Mesh,
    (text, kind): (&Pending, Option<&Pending>),
    out: &mut Outcome,
) -> Result<(), MeshError> {
    let source = lookup.source;
    text.keyword.only(source, &["CONSTRAINT NAME", "REF NODE", "SURFACE"])?;
    let Some(kind) = kind else {
        let found = "*COUPLING without what it does";
        return Err(source.malformed(
            text.keyword.place(source),
            found,
            "*KINEMATIC or *DISTRIBUTING under it",
        ));
    };
    let name = lookup.title(text, "CONSTRAINT NAME");
    let reference = lookup.reference(text, "REF NODE")?;
    let surface = lookup.surface(mesh, text, text.keyword.required(source, "SURFACE")?)?;
    let mut components = [false; 6];
    for row in &kind.rows {
        components[lookup.components(row, 0)?].fill(true);
    }
    if kind.rows.is_empty() {
        components = [true; 6];
    }
    let rule = if kind.keyword.name == "KINEMATIC" {
        kind.keyword.only(source, &[])?;
        let nodes = surface.nodes.iter().copied().filter(|node| *node != reference).collect();
        Rule::Rigid { reference, nodes, components, directions: GLOBAL }
    } else {
        kind.keyword.only(source, &["WEIGHTING METHOD", "COUPLING"])?;
        let method = kind.keyword.value("WEIGHTING METHOD").unwrap_or("UNIFORM");
        if !method.eq_ignore_ascii_case("UNIFORM") {
            let found = format!("WEIGHTING METHOD={method}");
            return Err(kind.keyword.refused(source, &found, "give UNIFORM"));
        }
        // Translations always stay coupled: "Only rotational degrees of freedom can be released" (Abaqus Keywords Guide, *DISTRIBUTING).
        components[..3].fill(true);
        let nodes = weighted(mesh, &surface, reference);
        Rule::Mean { reference, components, nodes, directions: GLOBAL }
    };
    out.push(lookup, text, Constraint { name, rule })
}

/// Weights of the nodes of a surface: the tributary area of each node if the surface consists of element faces, otherwise 1 (Abaqus
/// Analysis Guide, "Coupling constraints").
fn weighted(mesh: &Mesh, surface: &Surface, reference: usize) -> Vec<Weighted> {
    let mut weights: BTreeMap<usize, f64> = BTreeMap::new();
    if surface.faces.is_empty() {
        weights.extend(surface.nodes.iter().map(|node| (*node, 1.0)));
    }
    for face in &surface.faces {
        for (node, area) in face.tributary(mesh) {
            *weights.entry(node).or_insert(0.0) += area;
        }
    }
    // Corners of faces with eight nodes have a negative area: such nodes take no part.
    let sound = weights.into_iter().filter(|(node, weight)| *node != reference && *weight > 0.0);
    sound.map(|(node, weight)| Weighted { node, weight, components: [true; 3] }).collect()
}

/// Reads a rigid body: the nodes of element sets, and node sets, that follow the reference node.
pub(super) fn rigid_body(
    lookup: &Lookup,
    mesh: &Mesh,
    text: &Pending,
    out: &mut Outcome,
) -> Result<(), MeshError> {
    let source = lookup.source;
    text.keyword.only(source, &["REF NODE", "ELSET", "NSET", "TIE NSET", "PIN NSET"])?;
    let reference = lookup.reference(text, "REF NODE")?;
    let mut nodes = Vec::new();
    for parameter in ["ELSET", "NSET", "TIE NSET", "PIN NSET"] {
        let Some(name) = text.keyword.value(parameter) else { continue };
        let found = if parameter == "ELSET" {
            lookup.named.elements.members(name, text.within).map(|e| super::super::sets::nodes_of(mesh, e))
        } else {
            lookup.named.nodes.members(name, text.within).map(<[usize]>::to_vec)
        };
        nodes.extend(found.ok_or_else(|| {
            source.malformed(text.keyword.place(source), format!("{parameter}={name}"), "a set of this file")
        })?);
    }
    nodes.sort_unstable();
    nodes.dedup();
    nodes.retain(|node| *node != reference);
    if nodes.is_empty() {
        let found = "*RIGID BODY without nodes";
        return Err(source.malformed(
            text.keyword.place(source),
            found,
            "ELSET=... or NSET=... with members",
        ));
    }
    let rule = Rule::Rigid { reference, nodes, components: [true; 6], directions: GLOBAL };
    out.push(lookup, text, Constraint { name: lookup.title(text, "REF NODE"), rule })
}

/// Reads the mass of the mass elements in a set; every element of the set has this mass.
pub(super) fn mass(lookup: &Lookup, text: &Pending, out: &mut Outcome) -> Result<(), MeshError> {
    let source = lookup.source;
    text.keyword.only(source, &["ELSET"])?;
    let set = text.keyword.required(source, "ELSET")?;
    let own = text.within.checked_sub(1).map(|at| format!("{}.{set}", lookup.instances[at]).to_uppercase());
    let nodes = own.and_then(|own| lookup.mass_elements.get(&own));
    let Some(nodes) = nodes.or_else(|| lookup.mass_elements.get(&set.to_uppercase())) else {
        let expected = "the ELSET of an *ELEMENT, TYPE=MASS above";
        return Err(source.malformed(text.keyword.place(source), format!("ELSET={set}"), expected));
    };
    let Some(row) = text.rows.first() else {
        return Err(source.malformed(text.keyword.place(source), "*MASS without a value", "the mass"));
    };
    let value = lookup.number(row, 0, "the mass")?;
    if value < 0.0 {
        return Err(source.malformed(lookup.place(row), format!("the mass {value}"), "a mass >= 0"));
    }
    for label in nodes {
        let node = (lookup.index)(*label).ok_or_else(|| {
            source.malformed(
                text.keyword.place(source),
                format!("a mass element of {set} on an unknown node"),
                "a node of this file",
            )
        })?;
        let name = lookup.title(text, "ELSET");
        out.take(lookup, text, size_of::<PointMass>() + name.len())?;
        out.masses.push(PointMass { name, node, mass: value, offset: [0.0; 3], inertia: [[0.0; 3]; 3] });
    }
    Ok(())
}
