//! `$Elements`.

use super::super::error::MeshError;
use super::super::labels::{Labels, Twice};
use super::super::sets::TooLarge;
use super::super::topology::Element;
use super::cursor::Cursor;
use super::element_types::{self, ElementType, Use};
use super::reader::Reader;

/// Reads elements into the mesh, and the sets of all physical groups.
pub(super) fn read(cursor: &mut Cursor, reader: &mut Reader) -> Result<(), MeshError> {
    let blocks = cursor.count("the number of blocks of elements", 4)?;
    let total = cursor.count("the number of elements", 2)?;
    cursor.size("the smallest element number")?;
    cursor.size("the largest element number")?;
    let mut seen = 0;
    for _ in 0..blocks {
        seen += block(cursor, reader)?;
    }
    if seen != total {
        let found = format!("{seen} elements in the blocks");
        return Err(cursor.source.malformed(
            cursor.place(),
            found,
            format!("{total}, as $Elements promises"),
        ));
    }
    numbered_once(cursor, reader)
}

/// Refuses an element number that occurs twice.
pub(super) fn numbered_once(cursor: &Cursor, reader: &Reader) -> Result<(), MeshError> {
    Labels::new(reader.mesh.elements.iter().map(|e| e.label)).map(|_| ()).map_err(
        |Twice { label, .. }| {
            let place = format!("$Elements, which ends at {}", cursor.place());
            let found = format!("element {label} twice");
            cursor.source.malformed(place, found, "a number of its own for every element")
        },
    )
}

/// Reads one block and returns the number of its elements.
fn block(cursor: &mut Cursor, reader: &mut Reader) -> Result<usize, MeshError> {
    let start = cursor.offset();
    let entity =
        (cursor.integer("the dimension of the entity")?, cursor.integer("the number of the entity")?);
    let number = cursor.integer("the type of the elements")?;
    let kind = known(cursor, start, number)?;
    let count = cursor.count("the number of elements in the block", kind.nodes + 1)?;
    if count == 0 {
        return Ok(0);
    }
    if let Use::Refused(_) = kind.role {
        let label = cursor.size("the number of an element")?;
        usable(cursor, start, kind, label)?;
    }
    let sets = reader.groups.sets_of(entity);
    let first = reader.mesh.elements.len();
    let mut nodes = Vec::new();
    for _ in 0..count {
        let (label, element) = element(cursor, reader, kind)?;
        nodes.extend_from_slice(&element);
        if let Use::Element(shape) = kind.role {
            reader.mesh.elements.push(Element { label, shape, nodes: element });
        }
    }
    nodes.sort_unstable();
    nodes.dedup();
    sets.iter().try_for_each(|name| join(cursor, reader, start, name, (kind, &nodes, first)))?;
    Ok(count)
}

/// The element type with this number.
pub(super) fn known(cursor: &Cursor, start: usize, number: i32) -> Result<&'static ElementType, MeshError> {
    element_types::find(number).ok_or_else(|| {
        let remedy = "mesh in first or second order (in Gmsh: Mesh.ElementOrder = 1 or 2)";
        cursor.source.unsupported(cursor.place_at(start), format!("element type {number}"), remedy)
    })
}

/// Refuses elements with which the program cannot compute.
pub(super) fn usable(cursor: &Cursor, start: usize, kind: &ElementType, label: u64) -> Result<(), MeshError> {
    let Use::Refused(remedy) = kind.role else { return Ok(()) };
    let found = format!("element {label}, a {} (type {}),", kind.name, kind.number());
    Err(cursor.source.unsupported(cursor.place_at(start), found, remedy))
}

/// Adds nodes, and the elements from `first` on, to the sets of a physical group.
pub(super) fn join(
    cursor: &Cursor,
    reader: &mut Reader,
    start: usize,
    name: &str,
    (kind, nodes, first): (&ElementType, &[usize], usize),
) -> Result<(), MeshError> {
    let added = reader.node_sets.extend(name, nodes.iter().copied());
    let last = reader.mesh.elements.len();
    let added = match kind.role {
        Use::Element(_) => added.and_then(|()| reader.element_sets.extend(name, first..last)),
        _ => added,
    };
    added.map_err(|limit| too_large(cursor, start, name, limit))
}

fn too_large(cursor: &Cursor, start: usize, name: &str, TooLarge { limit }: TooLarge) -> MeshError {
    let found = format!("more than {limit} entries in all sets together, at the group {name:?},");
    cursor.source.unsupported(cursor.place_at(start), found, "put entities into fewer physical groups")
}

/// Number and nodes of one element, in the order of [`Shape`](super::super::topology::Shape).
fn element(cursor: &mut Cursor, reader: &Reader, kind: &ElementType) -> Result<(u64, Vec<usize>), MeshError> {
    let label = cursor.size("the number of an element")?;
    Ok((label, nodes(cursor, reader, kind, label)?))
}

/// Indices of the nodes of an element.
pub(super) fn nodes(
    cursor: &mut Cursor,
    reader: &Reader,
    kind: &ElementType,
    label: u64,
) -> Result<Vec<usize>, MeshError> {
    let mut nodes = Vec::with_capacity(kind.nodes);
    for _ in 0..kind.nodes {
        let start = cursor.offset();
        let node = cursor.size(format_args!("a node of element {label}"))?;
        let index = reader.nodes.as_ref().and_then(|labels| labels.index(node)).ok_or_else(|| {
            let place = format!("{}, element {label}", cursor.place_at(start));
            cursor.source.malformed(place, format!("node {node}"), "the number of a node in $Nodes")
        })?;
        nodes.push(index);
    }
    if let Use::Element(shape) = kind.role
        && let Some(places) = element_types::places(shape)
    {
        nodes = places.iter().map(|at| nodes[*at]).collect();
    }
    Ok(nodes)
}
