//! The outside of a mesh: faces that belong to one element only.

use std::collections::BTreeMap;

use super::topology::Mesh;

impl Mesh {
    /// The outer faces: index of the element, and of the nodes at the corners, counter-clockwise seen from outside. A triangle
    /// repeats its third corner as the fourth.
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
            for face in element.shape.faces() {
                let corner = |at: usize| element.nodes[face[at.min(face.len() - 1)]];
                let corners: [usize; 4] = std::array::from_fn(corner);
                let mut key = corners;
                key.sort_unstable();
                // A face of two elements is inside. Two triangles that differ in the corner they repeat are one face.
                if face.len() == 3 {
                    key = [corners[0], corners[1], corners[2], usize::MAX];
                    key.sort_unstable();
                }
                seen.entry(key).and_modify(|entry| *entry = None).or_insert(Some((index, corners)));
            }
        }
        seen.into_values().flatten().collect()
    }
}
