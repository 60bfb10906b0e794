//! What all targets ask of a mesh reader.

use iwan_fem::mesh::read_bytes;
use std::path::Path;

/// Longest message, in characters: names that a file holds are shortened in it.
const LONGEST: usize = 2000;

/// Reads any bytes as a mesh file: an error that names the file or a sound mesh, never a panic.
///
/// # Panics
/// Where nodes, elements, sets or constraints name what is not there, a node is nowhere, or a message does not say which file it is about.
pub fn read(name: &str, bytes: &[u8]) {
    let file = match read_bytes(Path::new(name), bytes) {
        Ok(file) => file,
        Err(error) => {
            let text = error.to_string();
            assert!(text.starts_with(name) && text.chars().count() < LONGEST, "{text}");
            return;
        }
    };
    let mesh = file.mesh;
    let (nodes, elements) = (mesh.positions.len(), mesh.elements.len());
    assert!(mesh.positions.iter().flatten().all(|x| x.is_finite()));
    assert_eq!(mesh.node_labels.len(), nodes);
    assert!(mesh.elements.iter().all(|e| e.nodes.len() == e.shape.nodes()));
    assert!(mesh.elements.iter().flat_map(|e| &e.nodes).all(|n| *n < nodes));
    let sound = |set: &Vec<usize>, below| set.is_sorted() && set.iter().all(|i| *i < below);
    assert!(mesh.node_sets.values().all(|set| sound(set, nodes)));
    assert!(mesh.element_sets.values().all(|set| sound(set, elements)));
    assert!(file.constraints.iter().flat_map(|c| c.nodes()).all(|n| n < nodes));
    assert!(file.masses.iter().all(|m| m.node < nodes));
}
