//! `$Nodes` and `$Elements` of version 2, where every element carries the number of its physical group (Gmsh reference manual, "MSH file
//! format version 2 (Legacy)"). Counts are lines of text; in binary files the numbers are of type `int` and `double`.

use super::super::error::MeshError;
use super::super::labels::Labels;
use super::super::topology::{Element, Mesh};
use super::cursor::Cursor;
use super::element_types::{ElementType, Use};
use super::elements;
use super::nodes::numbered_once;
use super::reader::Reader;

/// Reads numbers and positions of all nodes into the mesh.
pub(super) fn nodes(cursor: &mut Cursor, mesh: &mut Mesh) -> Result<Labels, MeshError> {
    let count = cursor.text_count("the number of nodes", 4)?;
    for _ in 0..count {
        let label = cursor.size("the number of a node")?;
        let mut coordinate = |name| cursor.number(format_args!("{name} of node {label}"));
        mesh.positions.push([coordinate("x")?, coordinate("y")?, coordinate("z")?]);
        mesh.node_labels.push(label);
    }
    numbered_once(cursor, mesh)
}

/// Reads elements into the mesh, and the sets of all physical groups.
pub(super) fn elements(cursor: &mut Cursor, reader: &mut Reader) -> Result<(), MeshError> {
    let count = cursor.text_count("the number of elements", 4)?;
    let mut seen = 0;
    while seen < count {
        let start = cursor.offset();
        if cursor.is_binary() {
            // A header applies to as many elements of one type as it states.
            let number = cursor.integer("the type of the elements")?;
            let follow = cursor.size("the number of elements that follow")?;
            let tags = cursor.size("the number of tags")?;
            let kind = elements::known(cursor, start, number)?;
            if follow == 0 || follow > (count - seen) as u64 {
                let expected = format!("1 to {} elements, as $Elements promises", count - seen);
                let found = format!("a head for {follow} elements");
                return Err(cursor.source.malformed(cursor.place_at(start), found, expected));
            }
            for _ in 0..follow {
                let label = cursor.size("the number of an element")?;
                element(cursor, reader, start, (kind, label, tags))?;
            }
            seen += follow as usize;
        } else {
            let label = cursor.size("the number of an element")?;
            let number = cursor.integer(format_args!("the type of element {label}"))?;
            let kind = elements::known(cursor, start, number)?;
            let tags = cursor.size(format_args!("the number of tags of element {label}"))?;
            element(cursor, reader, start, (kind, label, tags))?;
            seen += 1;
        }
    }
    elements::numbered_once(cursor, reader)
}

/// Tags and nodes of one element; the first tag is its physical group, 0 for none.
fn element(
    cursor: &mut Cursor,
    reader: &mut Reader,
    start: usize,
    (kind, label, tags): (&ElementType, u64, u64),
) -> Result<(), MeshError> {
    elements::usable(cursor, start, kind, label)?;
    let mut group = 0;
    for tag in 0..tags {
        let value = cursor.integer(format_args!("a tag of element {label}"))?;
        if tag == 0 {
            group = value;
        }
    }
    let nodes = elements::nodes(cursor, reader, kind, label)?;
    let first = reader.mesh.elements.len();
    if let Use::Element(shape) = kind.role {
        reader.mesh.elements.push(Element { label, shape, nodes: nodes.clone() });
    }
    if group == 0 {
        return Ok(());
    }
    let name = reader.groups.name((kind.dimension(), group.saturating_abs()));
    elements::join(cursor, reader, start, &name, (kind, &nodes, first))
}
