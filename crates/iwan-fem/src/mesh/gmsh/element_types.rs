//! Element types of Gmsh.

use super::super::topology::Shape;

/// Use of an element.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Use {
    /// An element of the mesh.
    Element(Shape),
    /// Points, edges and faces: their nodes become members of the sets of their physical groups.
    Set,
    /// Refused, with this remedy.
    Refused(&'static str),
}

/// A type of element.
#[derive(Debug, Clone, Copy)]
pub(super) struct ElementType {
    number: i32,
    pub(super) name: &'static str,
    pub(super) nodes: usize,
    pub(super) role: Use,
}

const PYRAMID: Use = Use::Refused(
    "pyramids are not computed with: mesh the volume with tetrahedra, or make it transfinite (or extrude) with Recombine",
);
const INCOMPLETE: Use =
    Use::Refused("set Mesh.SecondOrderIncomplete = 1 in Gmsh for hexahedra of 20 and wedges of 15 nodes");

const fn entry(number: i32, name: &'static str, nodes: usize, role: Use) -> ElementType {
    ElementType { number, name, nodes, role }
}

static TYPES: &[ElementType] = &[
    entry(1, "2-node line", 2, Use::Set),
    entry(2, "3-node triangle", 3, Use::Set),
    entry(3, "4-node quadrangle", 4, Use::Set),
    entry(4, "4-node tetrahedron", 4, Use::Element(Shape::Tet4)),
    entry(5, "8-node hexahedron", 8, Use::Element(Shape::Hex8)),
    entry(6, "6-node prism", 6, Use::Element(Shape::Wedge6)),
    entry(7, "5-node pyramid", 5, PYRAMID),
    entry(8, "3-node line", 3, Use::Set),
    entry(9, "6-node triangle", 6, Use::Set),
    entry(10, "9-node quadrangle", 9, INCOMPLETE),
    entry(11, "10-node tetrahedron", 10, Use::Element(Shape::Tet10)),
    entry(12, "27-node hexahedron", 27, INCOMPLETE),
    entry(13, "18-node prism", 18, INCOMPLETE),
    entry(14, "14-node pyramid", 14, PYRAMID),
    entry(15, "1-node point", 1, Use::Set),
    entry(16, "8-node quadrangle", 8, Use::Set),
    entry(17, "20-node hexahedron", 20, Use::Element(Shape::Hex20)),
    entry(18, "15-node prism", 15, Use::Element(Shape::Wedge15)),
    entry(19, "13-node pyramid", 13, PYRAMID),
];

impl ElementType {
    /// Gmsh's number of the type.
    pub(super) const fn number(&self) -> i32 {
        self.number
    }

    /// Dimension of the entities that contain such elements.
    pub(super) const fn dimension(&self) -> i32 {
        match (self.role, self.number) {
            (Use::Set, 15) => 0,
            (Use::Set, 1 | 8) => 1,
            (Use::Set, _) => 2,
            _ => 3,
        }
    }
}

/// The type with this number; none for types of third and higher order.
pub(super) fn find(number: i32) -> Option<&'static ElementType> {
    TYPES.iter().find(|known| known.number == number)
}

/// Position in Gmsh's list of each node of a shape; none if the orders agree (Gmsh reference manual, "Node ordering").
///
/// Gmsh lists mid-edge nodes in this order of edges: in hexahedra 0-1, 0-3, 0-4, 1-2, 1-5, 2-3, 2-6, 3-7, 4-5, 4-7, 5-6, 6-7; in tetrahedra
/// 0-1, 1-2, 2-0, 3-0, 3-2, 3-1; in prisms 0-1, 0-2, 0-3, 1-2, 1-4, 2-5, 3-4, 3-5, 4-5.
pub(super) fn places(shape: Shape) -> Option<&'static [usize]> {
    match shape {
        Shape::Hex20 => Some(&[0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15]),
        Shape::Tet10 => Some(&[0, 1, 2, 3, 4, 5, 6, 7, 9, 8]),
        Shape::Wedge15 => Some(&[0, 1, 2, 3, 4, 5, 6, 9, 7, 12, 14, 13, 8, 10, 11]),
        Shape::Hex8 | Shape::Tet4 | Shape::Wedge6 => None,
    }
}
