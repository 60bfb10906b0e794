//! The outside of a mesh: faces that belong to one element only.

use std::collections::BTreeMap;

use super::topology::Mesh;

/// Faces of a hexahedron by its corners, seen from outside counter-clockwise.
const FACES: [[usize; 4]; 6] =
    [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];

impl Mesh {
    /// The outer faces: index of the element, and of the nodes at the corners, counter-clockwise seen from outside.
    ///
    /// ```
    /// use iwan_fem::mesh::block::{block, uniform};
    /// let mesh = block(&[uniform(0.0, 4.0, 4), uniform(0.0, 2.0, 2), uniform(0.0, 1.0, 1)]);
    /// assert_eq!(mesh.outer_faces().len(), 2 * (4 * 2 + 4 + 2));
    /// ```
    #[must_use]
    pub fn outer_faces(&self) -> Vec<(usize, [usize; 4])> {
        let mut seen: BTreeMap<[usize; 4], Option<(usize, [usize; 4])>> = BTreeMap::new();
        for (index, element) in self.elements.iter().enumerate() {
            for face in FACES {
                let corners = face.map(|corner| element.nodes[corner]);
                let mut key = corners;
                key.sort_unstable();
                // A face of two elements is inside.
                seen.entry(key).and_modify(|entry| *entry = None).or_insert(Some((index, corners)));
            }
        }
        seen.into_values().flatten().collect()
    }
}
