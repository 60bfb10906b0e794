//! `$Nodes`.

use super::super::error::MeshError;
use super::super::labels::{Labels, Twice};
use super::super::topology::Mesh;
use super::cursor::Cursor;

/// Reads numbers and positions of all nodes into the mesh.
pub(super) fn read(cursor: &mut Cursor, mesh: &mut Mesh) -> Result<Labels, MeshError> {
    let blocks = cursor.count("the number of blocks of nodes", 4)?;
    let total = cursor.count("the number of nodes", 4)?;
    cursor.size("the smallest node number")?;
    cursor.size("the largest node number")?;
    for _ in 0..blocks {
        block(cursor, mesh)?;
    }
    if mesh.positions.len() != total {
        let found = format!("{} nodes in the blocks", mesh.positions.len());
        return Err(cursor.source.malformed(cursor.place(), found, format!("{total}, as $Nodes promises")));
    }
    numbered_once(cursor, mesh)
}

/// Numbers of all nodes; a number that occurs twice is refused.
pub(super) fn numbered_once(cursor: &Cursor, mesh: &Mesh) -> Result<Labels, MeshError> {
    Labels::new(mesh.node_labels.iter().copied()).map_err(|Twice { label, .. }| {
        cursor.source.malformed(
            format!("$Nodes, which ends at {}", cursor.place()),
            format!("node {label} twice"),
            "a number of its own for every node",
        )
    })
}

fn block(cursor: &mut Cursor, mesh: &mut Mesh) -> Result<(), MeshError> {
    let dimension = cursor.integer("the dimension of the entity")?;
    cursor.integer("the number of the entity")?;
    let parametric = cursor.integer("whether parameters follow the coordinates (0 or 1)")? != 0;
    let parameters = if parametric { dimension.clamp(0, 3) } else { 0 };
    let count = cursor.count("the number of nodes in the block", 4)?;
    for _ in 0..count {
        let label = cursor.size("the number of a node")?;
        mesh.node_labels.push(label);
    }
    for index in mesh.positions.len()..mesh.node_labels.len() {
        let label = mesh.node_labels[index];
        let mut coordinate = |name| cursor.number(format_args!("{name} of node {label}"));
        let position = [coordinate("x")?, coordinate("y")?, coordinate("z")?];
        mesh.positions.push(position);
        for _ in 0..parameters {
            coordinate("a parameter")?;
        }
    }
    Ok(())
}
