//! `CHEXA`, `CPENTA`, `CTETRA` with `PSOLID` and `MAT1`.

use std::collections::BTreeMap;

use super::super::constraint::Section;
use super::super::error::MeshError;
use super::super::file::FileBytes;
use super::super::labels::{Labels, Twice};
use super::super::topology::{Element, Mesh, Shape};
use super::card::Card;
use super::grids::Grids;
use super::reader::Reader;

/// Position in Nastran's list of each node in the order of [`Shape`]: Nastran lists mid-edge nodes of the bottom edges first, then those of
/// the upright and of the top edges.
const HEX20: [usize; 20] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 16, 17, 18, 19, 12, 13, 14, 15];
const WEDGE15: [usize; 15] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 13, 14, 9, 10, 11];

/// Reads all elements into the mesh, with a set of elements and a set of nodes for each property; returns the properties' materials.
pub(super) fn read(
    source: FileBytes,
    reader: &Reader,
    grids: &Grids,
    mesh: &mut Mesh,
) -> Result<Vec<Section>, MeshError> {
    let mut of_property: BTreeMap<u64, Vec<usize>> = BTreeMap::new();
    for card in &reader.elements {
        let (shape, nodes) = nodes(source, card, grids)?;
        of_property.entry(card.label(source, 1)?).or_default().push(mesh.elements.len());
        mesh.elements.push(Element { label: card.label(source, 0)?, shape, nodes });
    }
    Labels::new(mesh.elements.iter().map(|e| e.label)).map_err(|Twice { label, second, .. }| {
        reader.elements[second].malformed(
            source,
            format!("element {label} twice"),
            "a number of its own for every element",
        )
    })?;
    let mut sections = Vec::new();
    for (property, elements) in of_property {
        let name = format!("PSOLID {property}");
        let mut nodes: Vec<usize> = elements.iter().flat_map(|e| &mesh.elements[*e].nodes).copied().collect();
        nodes.sort_unstable();
        nodes.dedup();
        sections.extend(section(source, reader, property, &name)?);
        mesh.node_sets.insert(name.clone(), nodes);
        mesh.element_sets.insert(name, elements);
    }
    Ok(sections)
}

/// Shape and nodes of an element.
fn nodes(source: FileBytes, card: &Card, grids: &Grids) -> Result<(Shape, Vec<usize>), MeshError> {
    let (small, large) = match card.name.as_str() {
        "CHEXA" => (Shape::Hex8, Shape::Hex20),
        "CPENTA" => (Shape::Wedge6, Shape::Wedge15),
        _ => (Shape::Tet4, Shape::Tet10),
    };
    let filled = (2..card.fields.len()).rev().find(|at| !card.field(*at).is_empty()).map_or(0, |at| at - 1);
    let shape = match filled {
        count if count == small.nodes() => small,
        count if count == large.nodes() => large,
        count => {
            let found = format!("element {} with {count} nodes", card.field(0));
            let expected = format!("{} or {} nodes", small.nodes(), large.nodes());
            return Err(card.malformed(source, found, expected));
        }
    };
    let found: Vec<usize> =
        (0..shape.nodes()).map(|k| grids.node(source, card, 2 + k)).collect::<Result<_, _>>()?;
    let places: &[usize] = match shape {
        Shape::Hex20 => &HEX20,
        Shape::Wedge15 => &WEDGE15,
        _ => return Ok((shape, found)),
    };
    Ok((shape, places.iter().map(|at| found[*at]).collect()))
}

/// Material of a property; none if the file gives no MAT1 for it, in which case the structure file must give one.
fn section(
    source: FileBytes,
    reader: &Reader,
    property: u64,
    name: &str,
) -> Result<Option<Section>, MeshError> {
    let Some(card) = reader.properties.get(&property) else { return Ok(None) };
    if card.field(6).eq_ignore_ascii_case("PFLUID") {
        let remedy = "leave the fluid out, or bring both in by [matrices]";
        return Err(card.unsupported(source, format!("PSOLID {property}, a fluid,"), remedy));
    }
    let number = card.label(source, 1)?;
    let Some(material) = reader.materials.get(&number) else { return Ok(None) };
    let optional = |at: usize| -> Result<Option<f64>, MeshError> {
        if material.field(at).is_empty() { Ok(None) } else { material.real(source, at, None).map(Some) }
    };
    // Two of E, G and ν are needed; the third follows.
    let (e, g, nu) = (optional(1)?, optional(2)?, optional(3)?);
    let (young, poisson) = match (e, g, nu) {
        (Some(e), _, Some(nu)) => (e, nu),
        (Some(e), Some(g), None) => (e, 0.5 * e / g - 1.0),
        (None, Some(g), Some(nu)) => (2.0 * g * (1.0 + nu), nu),
        _ => {
            let found = format!("material {number} with one of E, G and nu alone");
            return Err(material.malformed(source, found, "two of the three"));
        }
    };
    let density = material.real(source, 4, Some(0.0))? * reader.mass_factor.unwrap_or(1.0);
    let constants = [young, poisson, density];
    Ok(Some(Section { elements: name.into(), constants, material: format!("MAT1 {number}") }))
}
