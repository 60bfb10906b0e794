//! Nodes of the beam's top face, where sensors can be placed.

use iwan_fem::mesh::Mesh;

/// The highest nodes of the beam itself, without link and washers.
pub(crate) fn top_nodes(mesh: &Mesh) -> Vec<usize> {
    let nodes = beam_nodes(mesh);
    let height = |&n: &usize| mesh.positions[n][2];
    let top = nodes.iter().map(height).fold(f64::NEG_INFINITY, f64::max);
    nodes.into_iter().filter(|n| height(n) == top).collect()
}

/// Nodes of the beam itself, ascending.
fn beam_nodes(mesh: &Mesh) -> Vec<usize> {
    let elements = mesh.element_sets.get("beam").map_or(&[][..], Vec::as_slice);
    let mut nodes: Vec<usize> = elements.iter().flat_map(|&e| mesh.elements[e].nodes.clone()).collect();
    nodes.sort_unstable();
    nodes.dedup();
    nodes
}

#[cfg(test)]
mod tests {
    use super::*;
    use iwan_fem::mesh::beam::{Configuration, beam};

    /// 81 lines along the beam, 9 across (Sec. 3.1: the tip's edge has nine nodes); the link above them is not part of it.
    #[test]
    fn the_top_face_is_a_grid_of_nodes() {
        let mesh = beam(Configuration::B, 1);
        let top = top_nodes(&mesh);
        assert_eq!(top.len(), 81 * 9);
        assert!(top.iter().all(|&n| mesh.positions[n][2] == 0.25));
    }
}
