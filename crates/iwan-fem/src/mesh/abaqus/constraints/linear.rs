//! Readers of `*EQUATION`, `*MPC` and `*BOUNDARY`.

use super::super::super::constraint::{Constraint, Freedom, GLOBAL, Rule};
use super::super::super::error::MeshError;
use super::super::super::topology::Mesh;
use super::super::definition::{Pending, Row};
use super::lookup::Lookup;
use super::outcome::Outcome;

/// Reads equations: first the number of terms, then the node or set, the degree of freedom and the coefficient of each term. Sets of n
/// nodes give n equations, one for each node, in the order of the nodes in the mesh.
pub(super) fn equation(lookup: &Lookup, text: &Pending, out: &mut Outcome) -> Result<(), MeshError> {
    text.keyword.only(lookup.source, &[])?;
    let name = lookup.title(text, "NAME");
    let mut rows = text.rows.iter();
    while let Some(head) = rows.next() {
        let count = lookup.number(head, 0, "the number of terms")?;
        let mut terms: Vec<(Vec<usize>, usize, f64)> = Vec::new();
        while (terms.len() as f64) < count {
            let Some(row) = rows.next() else {
                let found = format!("{} terms of an equation", terms.len());
                return Err(lookup.source.malformed(
                    lookup.place(head),
                    found,
                    format!("{count}, as its first line says"),
                ));
            };
            for chunk in 0..row.fields.len().div_ceil(3) {
                let at = 3 * chunk;
                if row.fields[at..].iter().take(3).all(String::is_empty) {
                    continue;
                }
                let nodes = lookup.nodes(text, row, &row.fields[at])?;
                out.take(lookup, text, size_of_val(&nodes[..]))?;
                terms.push((
                    nodes,
                    lookup.component(row, at + 1)?,
                    lookup.number(row, at + 2, "a coefficient")?,
                ));
            }
        }
        let times = terms.iter().map(|term| term.0.len()).max().unwrap_or(0);
        if terms.iter().any(|term| term.0.len() != 1 && term.0.len() != times) {
            let found = "an equation between sets of different size";
            return Err(lookup.source.malformed(
                lookup.place(head),
                found,
                "sets of one node, or of equally many",
            ));
        }
        for k in 0..times {
            let term = |(nodes, component, c): &(Vec<usize>, usize, f64)| {
                let node = nodes[if nodes.len() == 1 { 0 } else { k }];
                (Freedom { node, component: *component }, *c)
            };
            let rule = Rule::Equation(terms.iter().map(term).collect());
            out.push(lookup, text, Constraint { name: name.clone(), rule })?;
        }
    }
    Ok(())
}

/// Reads `TYPE, a, b`: BEAM (a follows b as on a rigid arm, including rotation), TIE and PIN (equal displacements), LINK (constant
/// distance, linearised).
pub(super) fn multi_point(
    lookup: &Lookup,
    mesh: &Mesh,
    text: &Pending,
    out: &mut Outcome,
) -> Result<(), MeshError> {
    text.keyword.only(lookup.source, &[])?;
    let name = lookup.title(text, "NAME");
    for row in &text.rows {
        let kind = row.fields[0].to_ascii_uppercase();
        let (Some(first), Some(second), true) = (row.fields.get(1), row.fields.get(2), row.fields.len() == 3)
        else {
            let expected = "a type and two nodes";
            return Err(lookup.source.malformed(lookup.place(row), row.fields.join(", "), expected));
        };
        let (followers, leaders) = (lookup.nodes(text, row, first)?, lookup.nodes(text, row, second)?);
        if leaders.len() != 1 && leaders.len() != followers.len() {
            let found = format!("{} and {} nodes", followers.len(), leaders.len());
            return Err(lookup.source.malformed(
                lookup.place(row),
                found,
                "one leading node, or equally many on both sides",
            ));
        }
        for (k, &node) in followers.iter().enumerate() {
            let reference = leaders[if leaders.len() == 1 { 0 } else { k }];
            for rule in pair(lookup, mesh, row, &kind, (node, reference))? {
                out.push(lookup, text, Constraint { name: name.clone(), rule })?;
            }
        }
    }
    Ok(())
}

/// Constraints between two nodes.
fn pair(
    lookup: &Lookup,
    mesh: &Mesh,
    row: &Row,
    kind: &str,
    (node, reference): (usize, usize),
) -> Result<Vec<Rule>, MeshError> {
    let at = |node, component| Freedom { node, component };
    match kind {
        "BEAM" => {
            let (components, directions) = ([true; 6], GLOBAL);
            Ok(vec![Rule::Rigid { reference, nodes: vec![node], components, directions }])
        }
        "TIE" | "PIN" => {
            let equal = |axis| Rule::Equation(vec![(at(node, axis), 1.0), (at(reference, axis), -1.0)]);
            Ok((0..3).map(equal).collect())
        }
        "LINK" => {
            let arm: [f64; 3] =
                std::array::from_fn(|a| mesh.positions[node][a] - mesh.positions[reference][a]);
            if arm == [0.0; 3] {
                let expected = "two nodes at different places";
                return Err(lookup.source.malformed(lookup.place(row), "a LINK of no length", expected));
            }
            let terms = |node, sign: f64| (0..3).map(move |axis| (at(node, axis), sign * arm[axis]));
            Ok(vec![Rule::Equation(
                terms(node, 1.0).chain(terms(reference, -1.0)).filter(|t| t.1 != 0.0).collect(),
            )])
        }
        _ => {
            let found = format!("*MPC of type {kind}");
            let remedy = "obeyed are BEAM, TIE, PIN and LINK; say the same with *EQUATION, or in the structure file and \
                          pass over it with ignore = [\"MPC\"] in [mesh]";
            Err(lookup.source.unsupported(lookup.place(row), found, remedy))
        }
    }
}

/// Components that a word of `*BOUNDARY` holds at zero (Abaqus Keywords Guide, *BOUNDARY).
fn by_word(word: &str) -> Option<&'static [usize]> {
    Some(match word {
        "ENCASTRE" => &[0, 1, 2, 3, 4, 5],
        "PINNED" => &[0, 1, 2],
        "XSYMM" => &[0, 4, 5],
        "YSYMM" => &[1, 3, 5],
        "ZSYMM" => &[2, 3, 4],
        "XASYMM" => &[1, 2, 3],
        "YASYMM" => &[0, 2, 4],
        "ZASYMM" => &[0, 1, 5],
        _ => return None,
    })
}

/// Components that a row of `*BOUNDARY` holds at zero, from the first to the last one given.
fn by_number(lookup: &Lookup, row: &Row) -> Result<Vec<usize>, MeshError> {
    let components = lookup.components(row, 1)?;
    let given = row.fields.get(3).is_some_and(|field| !field.is_empty());
    if given && lookup.number(row, 3, "the displacement")? != 0.0 {
        let found = "a displacement that is not zero";
        let remedy = "hold the node at zero: loads are given in the structure file";
        return Err(lookup.source.unsupported(lookup.place(row), found, remedy));
    }
    Ok(components.collect())
}

/// Reads the nodes held at zero: `node or set, first, last`, or a word such as ENCASTRE in place of the two numbers.
pub(super) fn boundary(lookup: &Lookup, text: &Pending, out: &mut Outcome) -> Result<(), MeshError> {
    text.keyword.only(lookup.source, &[])?;
    let mut held = Vec::new();
    for row in &text.rows {
        let nodes = lookup.nodes(text, row, &row.fields[0])?;
        let word = row.fields.get(1).map(|field| field.to_ascii_uppercase()).unwrap_or_default();
        let components = match by_word(&word) {
            Some(components) => components.to_vec(),
            None => by_number(lookup, row)?,
        };
        out.take(lookup, text, size_of::<Freedom>() * nodes.len() * components.len())?;
        held.extend(
            nodes
                .iter()
                .flat_map(|&node| components.iter().map(move |&component| Freedom { node, component })),
        );
    }
    let name = lookup.title(text, "NAME");
    out.constraints.push(Constraint { name, rule: Rule::Held(held) });
    Ok(())
}
